/** \file
 * \brief One run of pcl_bayesian_icp: what it was given, what it does and what it
 * found.
 */
#pragma once

#include "io/cloud_file.h"
#include "register/settings.h"

#include <bayesian_icp/draws.h>
#include <bayesian_icp/prior.h>
#include <bayesian_icp/summary.h>

#include <functional>
#include <limits>
#include <vector>

namespace bayesian_icp::app {

/** \brief What a run found. Matrices are T_target_source. */
struct RegistrationResult {
  /** Whether ICP has run: not where the core was called by itself. */
  bool has_icp = true;
  bool icp_has_converged = false;
  Eigen::Matrix4d icp_matrix = Eigen::Matrix4d::Identity();
  /** Mean squared distance of the source, moved by ICP, to the target [m^2]. */
  double icp_fitness = 0.0;
  Summary summary;
  /** With which the draws were made. */
  Prior prior{Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()),
              PriorOptions().variance};
  /** Every chain, the diverged ones included. */
  std::vector<Chain> chains;
  Eigen::Matrix4d final_matrix = Eigen::Matrix4d::Identity();
  /** Whether final_matrix is that of the posterior mean, not ICP's. */
  bool is_final_the_mean = false;
  /** Wall time of ICP's iterations [s], ... */
  double icp_seconds = 0.0;
  /** ... and of all else: the surfaces, the estimate and the draws [s]. */
  double sampling_seconds = 0.0;
};

/** \brief A run for those who report it. */
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

/** \brief Told of the whole transformation T_target_source that ICP has come to, at its
 * start and after each of its iterations. */
using IcpCallback = std::function<void(const Eigen::Matrix4d& T_target_source)>;

/** \brief Run ICP and sample the posterior.
 * \param[in] source,target x, y, z [m], one point per column; not finite: skipped
 * \param[in] progress called after each step of the chains; returns false to cancel
 * \param[in] icp_progress called at ICP's start and after each of its iterations; may
 * be empty */
RegistrationResult
registerClouds(const Eigen::Matrix3Xf& source,
               const Eigen::Matrix3Xf& target,
               const Settings& settings,
               const ProgressCallback& progress,
               const IcpCallback& icp_progress = IcpCallback());

} // namespace bayesian_icp::app
