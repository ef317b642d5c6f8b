#include "batch/batch_line.h"

#include "register/json_values.h"
#include "register/posterior_json.h"

#include <algorithm>

namespace bayesian_icp::app {

namespace {

using nlohmann::ordered_json;

ordered_json
covariancesOf(const Summary& summary)
{
  auto list = ordered_json::array();
  for (const auto convention :
       {CovarianceConvention::Parameters, CovarianceConvention::RightSE3})
    list.push_back(covarianceJson(convention, summary.covariance(convention)));
  return list;
}

void
addPosterior(const Run& run, ordered_json& line)
{
  const RegistrationResult& result = run.result;
  line["mean"] = meanJson(result.summary.mean);
  line["covariances"] = covariancesOf(result.summary);
  line["final_transformation"] = finalTransformationJson(result);
  line["icp"] = icpJson(result);
  line["draws"] = result.summary.num_draws;
  line["source"] = cloudJson(run.source);
  line["target"] = cloudJson(run.target);
  line["time"] = {{"reading_s", run.reading_seconds},
                  {"icp_s", result.icp_seconds},
                  {"sampling_s", result.sampling_seconds}};
}

void
addNothing(const BatchPair& pair, ordered_json& line)
{
  for (const char* const key : {"mean", "covariances", "final_transformation", "icp"})
    line[key] = nullptr;
  line["draws"] = 0;
  line["source"] = {{"file", pair.source_file}};
  line["target"] = {{"file", pair.target_file}};
  line["time"] = ordered_json::object();
}

} // namespace

std::string
batchLine(const BatchResult& result)
{
  std::string message = result.message;
  std::replace(message.begin(), message.end(), '\n', ' ');
  ordered_json line = {
      {"name", result.pair.name}, {"status", result.status}, {"message", message}};
  if (result.run != nullptr)
    addPosterior(*result.run, line);
  else
    addNothing(result.pair, line);
  line["time"]["total_s"] = result.seconds;
  line["seed"] = result.pair.settings.options.chains.seed;
  line["settings_id"] = result.pair.settings_id;
  // Names of files need not be UTF-8.
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

FinishedPair
readBatchLine(const std::string& line)
{
  const auto json = nlohmann::json::parse(line);
  return {json.at("name"), json.at("settings_id"), json.at("status")};
}

} // namespace bayesian_icp::app
