/** \file
 * \brief Everything that decides the result of a run of pcl_bayesian_icp.
 */
#pragma once

#include <bayesian_icp/options.h>

#include <Eigen/Core>

#include <limits>
#include <string>

namespace bayesian_icp::app {

/** \brief Options of ICP and of the posterior; setting_fields.h names them for users.
 */
struct Settings {
  Options options;
  /** T_target_source at which ICP and the chains start. */
  Eigen::Matrix4d guess = Eigen::Matrix4d::Identity();
  /** Largest distance of corresponding points [m]. */
  double max_distance = std::numeric_limits<double>::infinity();
  /** ICP's, as in pcl_icp. */
  int icp_iterations = 50;
  bool is_reciprocal = false;
  bool is_one_to_one = false;
  /** Whether the posterior mean, not ICP's result, is the final transformation. */
  bool use_mean = false;

  /** Whether both clouds are scaled so that their largest |x|, |y|, |z| is 1 before
   * they are registered, as the paper's authors' program can (preset `paper`).
   * measurement_sigma, step_size and lambda_rms are then in scaled units; all other
   * lengths here stay in metres. */
  bool is_normalized = false;

  /** \brief Set by the authors' configuration files with normalize-cloud: guess, prior,
   * max_distance and initial_spread are still in scaled units. */
  bool are_lengths_scaled = false;
  /** \brief Set by the authors' configuration files: step_size is still to be divided
   * by the number of finite source points, which effective_points is to become. */
  bool is_step_size_times_points = false;
  bool is_effective_points_source_size = false;

  /** \brief What the user ought to know of the configuration file; empty if nothing. */
  std::string note;

  /** \brief Whether the clouds are to be scaled: preset `paper` alone has a scale of
   * its own, 1 m, that this changes. */
  bool
  isNormalized() const
  {
    return is_normalized && options.preset == Preset::Paper;
  }

  /** \brief Carry out what the flags above say.
   * \param[in] num_points finite points of the source
   * \param[in] largest_coordinate of both clouds [m] */
  void
  scaleToClouds(std::size_t num_points, double largest_coordinate);

  /** \brief Multiply guess, prior, max_distance and initial_spread by \p factor where
   * they are lengths. */
  void
  scaleLengths(double factor);

  /** \brief What is wrong with the first bad setting, with its command line option;
   * empty if all is well. */
  std::string
  validate() const;
};

/** \brief Refuse a setting that \p preset does not have, but another preset has.
 * \param[in] name "--option", "group" or "group.key"
 * \throws io::UsageError */
void
refuseOfOtherPresets(const std::string& name, Preset preset);

} // namespace bayesian_icp::app
