/** \file
 * \brief A target that is prepared once for many sources.
 */
#pragma once

#include <bayesian_icp/options.h>

#include <Eigen/Core>

#include <memory>

namespace bayesian_icp {

struct TargetParts;

/** \brief The points of a target, and what the presets make of them: the surface of
 * `calibrated`, the search tree of `paper` and `exact`.
 *
 * Each of these is made when it is first needed, or by prepare(), and then kept. No
 * result depends on when, or by how many threads, it was made. The object never changes
 * otherwise: several threads may use it at once, and its copies share everything. */
class BAYESIAN_ICP_EXPORT PreparedTarget {
public:
  /** \brief Not explicit: points are a target that nothing has been made of yet.
   * \param[in] points 3 x n, target frame [m]; non-finite points are left out */
  PreparedTarget(Eigen::Matrix3Xd points);

  /** \brief The same for an expression, such as points.cast<double>(). */
  template <typename Derived>
  PreparedTarget(const Eigen::MatrixBase<Derived>& points)
  : PreparedTarget(Eigen::Matrix3Xd(points))
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
  TargetParts&
  parts() const
  {
    return *parts_;
  }

private:
  std::shared_ptr<TargetParts> parts_;
};

} // namespace bayesian_icp
