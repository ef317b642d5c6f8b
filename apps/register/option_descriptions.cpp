#include "register/option_descriptions.h"

#include "io/numbers.h"
#include "register/choices.h"
#include "register/command_line.h"
#include "register/export_options.h"
#include "register/setting_fields.h"
#include "register/sgd_request.h"

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
  return std::string(field.help) + " One of " + namesOfChoices(value) + ". (default " +
         toString(value) + ")";
}

template <typename T>
std::string
described(const Field& field, const Automatic<T>& value)
{
  return value.isGiven() ? described(field, value.valueOr(T()))
                         : std::string(field.help) + " (default automatic)";
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
  group.add_options()("help,h", "Show this text.");
  group.add_options()("version", "Show the version.");
  group.add_options()("method",
                      text("NAME"),
                      "Method: bayesian-icp samples the posterior, sgd-icp finds a "
                      "pose only. (default bayesian-icp)");
  group.add_options()(
      "output,o",
      text("DIR"),
      "Write aligned.pcd, samples.csv, posterior.json and report.html to this folder, "
      "and make it if it is missing. report.html shows everything on one page and "
      "needs gnuplot. Without this option no file is written.");
  group.add_options()("no-report", "With --output: do not write report.html.");
  group.add_options()("json",
                      "Print the content of posterior.json instead of the table.");
  group.add_options()("quiet", "Print errors only, and show no progress bar.");
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
      "Read settings from a posterior.json, from its 'options' alone, or from a "
      "config.json of the authors' program. Options on the command line take "
      "precedence. Without it, all settings have their defaults.");
  Describer describe_registration{registration};
  visitRegistration(defaults, describe_registration);
  po::options_description posterior("Posterior");
  Describer describe_posterior{posterior};
  visitPosterior(defaults.options, describe_posterior);
  visitChains(defaults.options.chains, describe_posterior);
  options.add(registration).add(posterior);
  for (const Preset preset : choicesOf(Preset())) {
    po::options_description group(std::string("Preset ") + toString(preset));
    Describer describe{group};
    visitPreset(preset, defaults, describe);
    options.add(group);
  }
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

const char* const about_exact = R"(
Preset exact needs the truth about the sensor: --sigma, and --effective-points,
the number of independent measurements in the source.
)";

const char* const about_calibrated = R"(
Preset calibrated needs no truth about the sensor. It measures distances to the
target's surface in units of the noise that it finds there, and it accounts for
correlations between neighbouring points. It reports how well the clouds
determine the pose in each direction. Directions that they do not determine
stay at the prior, which has to be finite.
)";

} // namespace

std::string
helpText()
{
  std::ostringstream help;
  help << R"(Usage: pcl_bayesian_icp SOURCE TARGET [options]

Registers a source cloud to a target cloud by ICP and samples the posterior of
the pose that maps source points into the target frame: mean, covariance,
quantiles, draws. Clouds are .pcd or .ply files in metres. Options begin with
one or two dashes; their values follow a space or '='.
)" << describeOptions()
       << '\n'
       << describeSgdOptions() << about_exact << about_calibrated << aboutSgdIcp()
       << R"(
Exit codes:
  0    there is a posterior, and it can be trusted
  1    the registration failed, the chains have not mixed or are in several
       modes, the clouds call for doubt, or an export is not possible
  2    wrong usage
  3    a file cannot be read, used or written
  130  interrupted (Ctrl-C or SIGTERM); the draws until then are written

Example:
  pcl_bayesian_icp source.pcd target.pcd -d 0.1 --guess 0,0,0.2,0,0,1.57 -o out
  pcl_bayesian_icp source.pcd target.pcd --preset exact --sigma 0.005 \
      --effective-points 300 --prior-frame source-centroid
  pcl_bayesian_icp source.pcd target.pcd --prior-mean 0,0,0.2,0,0,1.57 \
      --prior-variance 0.01,0.01,0.01,0.04,0.04,0.04
)";
  return help.str();
}

} // namespace bayesian_icp::app
