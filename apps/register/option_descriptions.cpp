#include "register/option_descriptions.h"

#include "io/numbers.h"
#include "register/choices.h"
#include "register/command_line.h"
#include "register/export_options.h"
#include "register/setting_fields.h"
#include "sgd_icp/request.h"

#include <boost/program_options/value_semantic.hpp>

#include <sstream>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

std::string
described(const Field& field, double value)
{
  const std::string text = std::isfinite(value) ? io::textOf(value) : "none";
  return std::string(field.help) + " (default " + text + ")";
}

template <typename Integer>
std::enable_if_t<std::is_integral_v<Integer>, std::string>
described(const Field& field, Integer value)
{
  return std::string(field.help) + " (default " + io::textOf(value) + ")";
}

std::string
described(const Field& field, const Vector6d& value)
{
  const bool is_one_for_all = value.isConstant(value[0]);
  return field.help + (is_one_for_all ? " (default " + io::textOf(value[0]) + ")" : "");
}

std::string
described(const Field& field, const Eigen::Matrix4d&)
{
  return std::string(field.help) + " (default: identity)";
}

template <typename Choice>
std::enable_if_t<std::is_enum_v<Choice>, std::string>
described(const Field& field, Choice value)
{
  return std::string(field.help) + ": " + namesOfChoices(value) + " (default " +
         toString(value) + ")";
}

/** Makes an option of every setting. */
struct Describer {
  po::options_description& group;

  template <typename T>
  void
  operator()(const Field& field, const T& default_value)
  {
    if constexpr (std::is_same_v<T, bool>)
      group.add_options()(field.option, field.help);
    else
      group.add_options()(field.option,
                          po::value<std::string>()->value_name(field.placeholder),
                          described(field, default_value).c_str());
  }
};

po::options_description
describeGeneral()
{
  po::options_description group("General");
  const auto text = [](const char* placeholder) {
    return po::value<std::string>()->value_name(placeholder);
  };
  group.add_options()("help,h", "show this text");
  group.add_options()("version", "show the version");
  group.add_options()(
      "method",
      text("NAME"),
      "bayesian-icp, or sgd-icp for a pose without a posterior (default "
      "bayesian-icp)");
  group.add_options()(
      "output,o",
      text("DIR"),
      "write aligned.pcd, samples.csv, posterior.json and report.html (one page with "
      "all that is to be known, for a browser; needs gnuplot) into this folder, which "
      "is made if missing");
  group.add_options()("no-report", "with -o: do not write report.html");
  group.add_options()("json", "print what posterior.json has in place of the table");
  group.add_options()("quiet", "print nothing but errors, and no progress bar");
  return group;
}

} // namespace

void
describeSettings(const Settings& defaults, po::options_description& options)
{
  po::options_description registration("Registration");
  registration.add_options()(
      "config",
      po::value<std::string>()->value_name("FILE"),
      "settings as in the 'options' of a posterior.json, or a posterior.json "
      "itself, or a config.json of the authors' program; options on the "
      "command line come first");
  Describer describe_registration{registration};
  visitRegistration(defaults, describe_registration);
  po::options_description posterior("Posterior");
  Describer describe_posterior{posterior};
  visitPosterior(defaults.options, describe_posterior);
  po::options_description sampler("Sampler");
  Describer describe_sampler{sampler};
  visitSampler(defaults.options, describe_sampler);

  po::options_description exact("Preset exact only");
  Describer describe_exact{exact};
  visitExact(defaults.options.exact, describe_exact);
  po::options_description calibrated("Preset calibrated only");
  Describer describe_calibrated{calibrated};
  visitCalibrated(defaults.options.calibrated, describe_calibrated);

  options.add(registration).add(posterior).add(sampler).add(exact).add(calibrated);
}

po::options_description
describeOptions()
{
  po::options_description all;
  all.add(describeGeneral()).add(describeExportOptions());
  describeSettings(Settings(), all);
  return all;
}

namespace {

const char* const about_exact =
    "\nPreset exact needs the truth about the sensor: --sigma, and --effective-points, "
    "the\n"
    "number of independent measurements in the source. It finds --batch-size, "
    "--thinning,\n"
    "--burn-in and --step-size itself where they have their defaults; other values "
    "are\n"
    "obeyed, --step-size in (0, 1] as the largest step, 1 being a Newton step. It "
    "draws "
    "its\n"
    "mini-batches without replacement and uses no other constant of Algorithm 1.\n";

const char* const about_calibrated =
    "\nPreset calibrated needs no truth about the sensor: distances are to the "
    "target's\n"
    "surface, in units of the noise that is found there, and neighbouring points are "
    "not\n"
    "taken for independent. It reports how well the clouds hold the pose in each "
    "direction;\n"
    "those they do not hold stay at the prior, which has to be finite. Options of "
    "the\n"
    "scale, the mini-batches, the starts and the step sizes have no effect and are "
    "refused.\n";

} // namespace

std::string
helpText()
{
  std::ostringstream help;
  help
      << "Usage: pcl_bayesian_icp SOURCE TARGET [options]\n\n"
         "Registers a cloud to another by ICP and samples the posterior of the pose "
         "that\n"
         "maps source points into the target frame: mean, covariance, quantiles, "
         "draws.\n"
         "Clouds are .pcd or .ply files in metres. Options may begin with one dash or\n"
         "two, their values follow a blank or '='.\n"
      << describeOptions() << '\n'
      << describeSgdOptions() << about_exact << about_calibrated << aboutSgdIcp()
      << "\nExit codes:\n"
         "  0    the posterior is there and can be trusted\n"
         "  1    the registration failed, the chains have not mixed, they are in "
         "several\n"
         "       modes, the clouds call for doubt, or an export is not possible\n"
         "  2    wrong usage\n"
         "  3    a file cannot be read, used or written\n"
         "  130  interrupted (Ctrl-C or SIGTERM); what was drawn until then is "
         "written\n"
         "\nExample:\n"
         "  pcl_bayesian_icp source.pcd target.pcd -d 0.1 --guess 0,0,0.2,0,0,1.57 -o "
         "out\n"
         "  pcl_bayesian_icp source.pcd target.pcd --preset exact --sigma 0.005 \\\n"
         "      --effective-points 300 --prior-frame source-centroid\n"
         "  pcl_bayesian_icp source.pcd target.pcd --prior-mean 0,0,0.2,0,0,1.57 \\\n"
         "      --prior-variance 0.01,0.01,0.01,0.04,0.04,0.04\n";
  return help.str();
}

} // namespace bayesian_icp::app
