#include "register/data_json.h"

#include "register/json_values.h"

namespace bayesian_icp::app {

namespace {

using nlohmann::ordered_json;

ordered_json
directionsJson(const std::vector<DataDirection>& directions)
{
  auto list = ordered_json::array();
  for (const DataDirection& direction : directions)
    list.push_back(
        {{"description", direction.description},
         {"observability", toString(direction.observability)},
         {"standard_deviation_m", jsonOf(direction.standard_deviation)},
         {"prior_standard_deviation_m", jsonOf(direction.prior_standard_deviation)},
         {"information_in_units_of_the_prior", jsonOf(direction.relative_information)},
         {"twist", jsonOf(direction.twist)}});
  return list;
}

ordered_json
flagsJson(const DataFlags& flags)
{
  return {{"wrong_basin", flags.wrong_basin},
          {"low_support", flags.low_support},
          {"few_patches", flags.few_patches},
          {"misfit", flags.misfit},
          {"no_information", flags.no_information},
          {"prior_conflict", flags.prior_conflict}};
}

} // namespace

ordered_json
dataJson(const DataReport& report)
{
  if (!report.is_available)
    return nullptr;
  return {
      {"noise_scale_m", jsonOf(report.noise_scale)},
      {"noise_scale_in_units_of_the_target", jsonOf(report.residual_scale)},
      {"effective_patches", jsonOf(report.effective_patches)},
      {"degrees_of_freedom", report.degrees_of_freedom},
      {"correlation_factor", jsonOf(report.correlation_factor)},
      {"active_fraction", jsonOf(report.active_fraction)},
      {"basin_distance_in_standard_deviations", jsonOf(report.basin_distance)},
      {"other_start_cost_ratio", jsonOf(report.other_cost_ratio)},
      {"prior_probability", jsonOf(report.prior_probability)},
      {"flags", flagsJson(report.flags)},
      {"flag_messages", describeFlags(report)},
      {"centre_m", jsonOf(report.centre)},
      {"directions", directionsJson(report.directions)},
      {"directions_note",
       "best known first; twist (v, w) [1, rad/m] in the target frame, T = exp(xi) T "
       "about centre_m, of unit root mean squared displacement of the source's points: "
       "a standard deviation in m along it is |w| times as many rad"}};
}

} // namespace bayesian_icp::app
