#include <bayesian_icp/exports.h>
#include <bayesian_icp/summary.h>

namespace bayesian_icp {

const char*
toString(Status status)
{
  switch (status) {
  case Status::NotRun:
    return "not_run";
  case Status::Ok:
    return "ok";
  case Status::Doubtful:
    return "doubtful";
  case Status::NotMixed:
    return "not_mixed";
  case Status::SeveralModes:
    return "several_modes";
  case Status::Diverged:
    return "diverged";
  case Status::Cancelled:
    return "interrupted";
  case Status::TooFewCorrespondences:
    return "too_few_correspondences";
  case Status::InvalidOptions:
    return "invalid_options";
  case Status::InvalidInput:
    return "invalid_input";
  }
  return "unknown";
}

bool
readStatus(const std::string& name, Status& status)
{
  for (const Status candidate : {Status::NotRun,
                                 Status::Ok,
                                 Status::Doubtful,
                                 Status::NotMixed,
                                 Status::SeveralModes,
                                 Status::Diverged,
                                 Status::Cancelled,
                                 Status::TooFewCorrespondences,
                                 Status::InvalidOptions,
                                 Status::InvalidInput})
    if (name == toString(candidate)) {
      status = candidate;
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
