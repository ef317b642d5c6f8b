/** \file
 * \brief pcl_bayesian_icp_evaluate, run as a user would.
 */
#pragma once

#include "evaluation/csv_rows.h"

#include <string>

/** \brief Runs the tool in a folder of the test's own. */
class EvaluateTool : public FolderTest {
protected:
  /** \brief Run a sub-command.
   * \param[in] environment variables of it, as a shell takes them */
  CommandResult
  run(const std::string& arguments, const std::string& environment = "") const
  {
    return runShell("cd '" + folder_.string() + "' && " + environment +
                    " '" BAYESIAN_ICP_EVALUATE "' " + arguments);
  }
};
