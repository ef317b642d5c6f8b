// The library in a program whose numbers have decimal commas: what it says and exports
// is the same as elsewhere.
#include <bayesian_icp/exports.h>
#include <bayesian_icp/pipeline.h>
#include <bayesian_icp/random.h>

#include <gtest/gtest.h>

#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <sstream>

namespace bayesian_icp {
namespace {

namespace fs = std::filesystem;

/** The program in the locale de_DE.UTF-8, made for it, as long as this object lives. */
class GermanProgram {
public:
  GermanProgram()
  : folder_(fs::temp_directory_path() /
            ("bayesian_icp_locale_" + std::to_string(getpid())))
  {
    fs::create_directories(folder_);
    const std::string command = "localedef -i de_DE -f UTF-8 '" +
                                (folder_ / "de_DE.UTF-8").string() + "' 2> /dev/null";
    if (std::system(command.c_str()) != 0)
      return;
    setenv("LOCPATH", folder_.c_str(), 1);
    previous_ = std::locale::global(std::locale("de_DE.UTF-8"));
    is_german_ = true;
  }
  ~GermanProgram()
  {
    if (is_german_)
      std::locale::global(previous_);
    unsetenv("LOCPATH");
    fs::remove_all(folder_);
  }
  GermanProgram(const GermanProgram&) = delete;
  GermanProgram&
  operator=(const GermanProgram&) = delete;

  bool
  isGerman() const
  {
    return is_german_;
  }

private:
  fs::path folder_;
  std::locale previous_;
  bool is_german_ = false;
};

/** All text of an estimate that has numbers, and the formats for other software. */
std::string
textsOfTheLibrary()
{
  Random random(1, 0);
  const auto surface = [&random](Eigen::Index num_points) {
    Eigen::Matrix3Xd points(3, num_points);
    for (Eigen::Index i = 0; i < num_points; ++i) {
      const double x = random.uniform() - 0.5, y = random.uniform() - 0.5;
      points.col(i) << x, y,
          0.05 * std::sin(9.0 * x) * std::cos(8.0 * y) + 0.003 * random.normal();
    }
    return points;
  };
  const Eigen::Matrix3Xd source = surface(1000), target = surface(4000);
  Options options;
  options.chains.num_draws = 1200;
  std::string text;
  for (const Preset preset : {Preset::Calibrated, Preset::Paper}) {
    options.preset = preset;
    const Summary summary =
        estimatePosterior(source, target, Vector6d::Zero(), options).summary;
    text += summary.message + '\n';
    for (const DataDirection& direction : summary.data.directions)
      text += direction.description + '\n';
    if (summary.status != Status::Ok)
      continue; // not for export
    const PoseEstimate estimate(summary);
    ExportOptions formats;
    formats.timestamp_ns = 1234567890123456789;
    text += rosYaml(estimate, formats) + g2oEdge(estimate, formats) +
            gtsamText(estimate, formats) + tumLine(estimate, formats) +
            csvText(estimate, formats);
  }
  options.paper.sgld.step_size = -1234.5;
  return text + options.validate();
}

TEST(Locale, DecimalCommasOfTheProgramAreNotTheLibrarys)
{
  const std::string plain = textsOfTheLibrary();
  EXPECT_NE(plain.find("step_size is -1234.5"), std::string::npos) << plain;
  EXPECT_NE(plain.find("EDGE_SE3:QUAT"), std::string::npos) << plain;
  const GermanProgram program;
  if (!program.isGerman())
    GTEST_SKIP() << "no sources of locales here (package locales)";
  std::ostringstream number;
  number << 1234.5;
  ASSERT_EQ(number.str(), "1.234,5");
  ASSERT_EQ(std::localeconv()->decimal_point, std::string(","));
  EXPECT_EQ(textsOfTheLibrary(), plain);
}

} // namespace
} // namespace bayesian_icp
