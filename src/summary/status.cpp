#include "options/enumerator_names.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/summary.h>

namespace bayesian_icp {

const char*
toString(Status status)
{
  return nameOf(status,
                {"not_run",
                 "ok",
                 "doubtful",
                 "not_mixed",
                 "several_modes",
                 "diverged",
                 "interrupted",
                 "too_few_correspondences",
                 "invalid_options",
                 "invalid_input"});
}

bool
readStatus(const std::string& name, Status& status)
{
  for (auto found = Status::NotRun; found <= Status::InvalidInput;
       found = static_cast<Status>(static_cast<int>(found) + 1))
    if (name == toString(found)) {
      status = found;
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
