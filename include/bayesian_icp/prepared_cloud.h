/** \file
 * \brief A cloud that is prepared once for many registrations.
 */
#pragma once

#include <bayesian_icp/options.h>

#include <Eigen/Core>

#include <memory>

namespace bayesian_icp {

struct CloudParts;

/** \brief The points of a cloud, and what the presets derive from them: the surfaces of
 * target and source for `calibrated`, and the search tree of the target for `paper` and
 * `exact`. In odometry, a scan is the source first, and then the target.
 *
 * Each of these is made when it is first needed, or by prepare(), and then kept. No
 * result depends on when, or by how many threads, it was made. Otherwise the object
 * never changes: several threads may use it at once, and its copies share everything.
 */
class BAYESIAN_ICP_EXPORT PreparedCloud {
public:
  /** \brief Not explicit, so that points can be passed as a cloud.
   * \param[in] points 3 x n, in the cloud's own frame [m]; non-finite points of a
   *            target are left out */
  PreparedCloud(Eigen::Matrix3Xd points);

  /** \brief The same for an expression, such as points.cast<double>(). */
  template <typename Derived>
  PreparedCloud(const Eigen::MatrixBase<Derived>& points)
  : PreparedCloud(Eigen::Matrix3Xd(points))
  {}

  /** \brief The points that were given, [m]. */
  const Eigen::Matrix3Xd&
  points() const;

  /** \brief Prepare what \p preset needs, so that the first estimate does not have to.
   * Preset `calibrated` prepares more for a cloud of another size.
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
