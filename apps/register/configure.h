/** \file
 * \brief Settings into an object of the PCL class.
 */
#pragma once

#include "register/settings.h"

#include <pcl/registration/correspondence_rejection_one_to_one.h>

#include <cmath>

namespace bayesian_icp::app {

/** \brief Give \p icp, which is new, everything of \p settings but the guess.
 * \tparam Icp a pcl::BayesianIterativeClosestPoint */
template <typename Icp>
void
configure(const Settings& settings, Icp& icp)
{
  icp.setOptions(settings.options);
  icp.setMaximumIterations(settings.icp_iterations);
  icp.setUseReciprocalCorrespondences(settings.is_reciprocal);
  if (std::isfinite(settings.max_distance))
    icp.setMaxCorrespondenceDistance(settings.max_distance);
  if (settings.is_one_to_one)
    icp.addCorrespondenceRejector(
        pcl::make_shared<pcl::registration::CorrespondenceRejectorOneToOne>());
}

} // namespace bayesian_icp::app
