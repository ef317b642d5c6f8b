/** \file
 * \brief A cloud that is prepared once for many registrations.
 */
#pragma once

#include <bayesian_icp/options.h>

#include <Eigen/Core>

#include <memory>

namespace bayesian_icp {

struct CloudParts;

/** \brief The points of a cloud, and what the presets make of them: the surface that
 * `calibrated` needs of target and source, and the search tree that `paper` and `exact`
 * need of the target. In odometry, a scan is the source first, and then the target.
 *
 * Each of these is made when it is first needed, or by prepare(), and then kept. No
 * result depends on when, or by how many threads, it was made. The object never changes
 * otherwise: several threads may use it at once, and its copies share everything. */
class BAYESIAN_ICP_EXPORT PreparedCloud {
public:
  /** \brief Not explicit: points are a cloud that nothing has been made of yet.
   * \param[in] points 3 x n, in the cloud's own frame [m]; of a target, non-finite
   *            points are left out */
  PreparedCloud(Eigen::Matrix3Xd points);

  /** \brief The same for an expression, such as points.cast<double>(). */
  template <typename Derived>
  PreparedCloud(const Eigen::MatrixBase<Derived>& points)
  : PreparedCloud(Eigen::Matrix3Xd(points))
  {}

  /** \brief The points that were given, [m]. */
  const Eigen::Matrix3Xd&
  points() const;

  /** \brief Make what \p preset needs, so that the first estimate need not.
   * \param[in] preset that will be used
   * \param[in] num_threads OpenMP threads, 0 is automatic */
  void
  prepare(Preset preset, int num_threads = 0) const;

  /** \brief Internal. */
  CloudParts&
  parts() const
  {
    return *parts_;
  }

private:
  std::shared_ptr<CloudParts> parts_;
};

} // namespace bayesian_icp
