#include <bayesian_icp/exports.h>
#include <bayesian_icp/summary.h>

#include <utility>

namespace bayesian_icp {

namespace {

constexpr std::pair<Status, const char*> status_names[] = {
    {Status::NotRun, "not_run"},
    {Status::Ok, "ok"},
    {Status::Doubtful, "doubtful"},
    {Status::NotMixed, "not_mixed"},
    {Status::SeveralModes, "several_modes"},
    {Status::Diverged, "diverged"},
    {Status::Cancelled, "interrupted"},
    {Status::TooFewCorrespondences, "too_few_correspondences"},
    {Status::InvalidOptions, "invalid_options"},
    {Status::InvalidInput, "invalid_input"}};

} // namespace

const char*
toString(Status status)
{
  for (const auto& [named, name] : status_names)
    if (named == status)
      return name;
  return "unknown";
}

bool
readStatus(const std::string& name, Status& status)
{
  for (const auto& [named, its_name] : status_names)
    if (its_name == name) {
      status = named;
      return true;
    }
  return false;
}

bool
hasUsableMean(Status status)
{
  return status == Status::Ok || status == Status::Doubtful ||
         status == Status::NotMixed;
}

} // namespace bayesian_icp
