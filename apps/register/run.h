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

/** \brief Read both clouds, and scale the settings to the source where asked for.
 * \throws io::FileError */
Run
readRun(const std::string& source_file,
        const std::string& target_file,
        const Settings& settings);

/** \brief Register the clouds of \p run.
 * \param[in] progress called after each step of the chains; returns false to cancel
 * \param[in] icp_progress as in registration.h */
void
registerClouds(const ProgressCallback& progress,
               Run& run,
               const IcpCallback& icp_progress = IcpCallback());

} // namespace bayesian_icp::app
