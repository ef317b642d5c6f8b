#include "batch/batch_line.h"

#include "register/json_values.h"
#include "register/posterior_json.h"

#include <algorithm>

namespace bayesian_icp::app {

namespace {

using nlohmann::ordered_json;

std::string
textOf(const ordered_json& line)
{
  // Names of files need not be UTF-8.
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json
headOf(const BatchPair& pair, const std::string& status, std::string message)
{
  std::replace(message.begin(), message.end(), '\n', ' ');
  return {{"name", pair.name}, {"status", status}, {"message", message}};
}

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
addTail(const BatchPair& pair, double seconds, ordered_json time, ordered_json& line)
{
  time["total_s"] = seconds;
  line["time"] = std::move(time);
  line["seed"] = pair.settings.options.chains.seed;
  line["settings_id"] = pair.settings_id;
}

} // namespace

std::string
batchLine(const BatchPair& pair, const Run& run, double seconds)
{
  const RegistrationResult& result = run.result;
  const Summary& summary = result.summary;
  ordered_json line = headOf(pair, toString(summary.status), summary.message);
  line["mean"] = meanJson(summary.mean);
  line["covariances"] = covariancesOf(summary);
  line["final_transformation"] = finalTransformationJson(result);
  line["icp"] = icpJson(result);
  line["draws"] = summary.num_draws;
  line["source"] = cloudJson(run.source);
  line["target"] = cloudJson(run.target);
  addTail(pair,
          seconds,
          {{"reading_s", run.reading_seconds},
           {"icp_s", result.icp_seconds},
           {"sampling_s", result.sampling_seconds}},
          line);
  return textOf(line);
}

std::string
batchErrorLine(const BatchPair& pair, const std::string& message, double seconds)
{
  ordered_json line = headOf(pair, error_status, message);
  for (const char* const key : {"mean", "covariances", "final_transformation", "icp"})
    line[key] = nullptr;
  line["draws"] = 0;
  line["source"] = {{"file", pair.source_file}};
  line["target"] = {{"file", pair.target_file}};
  addTail(pair, seconds, ordered_json::object(), line);
  return textOf(line);
}

FinishedPair
readBatchLine(const std::string& line)
{
  const auto json = nlohmann::json::parse(line);
  return {json.at("name"), json.at("settings_id"), json.at("status")};
}

} // namespace bayesian_icp::app
