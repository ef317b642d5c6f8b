/** \file
 * \brief What one run of pcl_bayesian_icp was given and found, for those who report it.
 */
#pragma once

#include "io/cloud_file.h"
#include "register/registration.h"
#include "register/settings.h"

namespace bayesian_icp::app {

struct Run {
  io::CloudFile source;
  io::CloudFile target;
  /** As they were used: scaled to the source where that was asked for. */
  Settings settings;
  RegistrationResult result;
  double reading_seconds = 0.0;
};

} // namespace bayesian_icp::app
