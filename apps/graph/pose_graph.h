/** \file
 * \brief Poses that are known to a covariance, and edges between them.
 */
#pragma once

#include <bayesian_icp/exports.h>

#include <string>
#include <utility>
#include <vector>

namespace bayesian_icp::app {

/** \brief A pose that is known as well as its covariance says. */
struct GaussianPose {
  /** (x, y, z, roll, pitch, yaw) [m, rad]. */
  Vector6d mean = Vector6d::Zero();
  /** CovarianceConvention::RightSE3, in the frame of the scan [m, rad]. */
  Matrix6d covariance = Matrix6d::Zero();
};

/** \brief Parts of the variance of an edge that it has in common with others. Measured
 * on simulated drives with three sensors (docs/track.md). From 0, and 2 scan + common
 * below 1. */
struct SharedNoise {
  /** Of each of its two scans: the noise of its points, which moves the scan. As the
   * target it moves the edge the other way than as the source, so that it cancels along
   * a chain. */
  double scan = 0.25;
  /** With all edges of the graph that move in the same direction: what a sensor does
   * wrong in each scan, such as the offsets of its rings. It is the other way if the
   * motion is, because both scans are treated alike. */
  double common = 0.2;

  /** \brief The part that an edge has for itself. */
  constexpr double
  own() const
  {
    return 1.0 - 2.0 * scan - common;
  }
};

/** \brief The symmetric S^1/2. Eigenvalues below 0, which are rounding next to the
 * variance of a motion that the clouds do not see, count as 0. */
Matrix6d
squareRootOf(const Matrix6d& covariance);

/** \brief Ad(T) of twists (v, w): T exp(xi) = exp(Ad(T) xi) T. With T.inverse() it
 * carries them from the left to the right. */
Matrix6d
adjointOf(const Eigen::Matrix4d& T);

/** \brief Of a scan's noise, in its axes and in units of the deviations of its edges,
 * to the axes of a source whose pose in that scan is \p T. */
Matrix6d
noiseToSource(const Eigen::Matrix4d& T);

/** \brief The twist of \p T over its length, a radian counting as a metre; of no motion
 * the x axis. */
Vector6d
directionOf(const Eigen::Matrix4d& T);

/** \brief How many numbers all edges have in common: G of GraphEdge::shared. */
constexpr int num_common = 36;

/** \brief An error as a sum over those, column by column. */
using CommonFactors = Eigen::Matrix<double, 6, num_common>;

/** \brief S^1/2 sqrt(common) G d, see GraphEdge::shared.
 * \param[in] root S^1/2
 * \param[in] T T_target_source
 * \param[in] common share of the variance */
CommonFactors
commonFactors(const Matrix6d& root, const Eigen::Matrix4d& T, double common);

/** \brief Where a trajectory comes back to where it was: for each pose the nearest
 * earlier one within \p radius, if in between the trajectory was more than twice the
 * radius away. Near neighbours in the sequence are no loops by that.
 * \param[in] radius [m]
 * \return pairs (earlier, later), in the order of the later ones */
std::vector<std::pair<int, int>>
loopCandidates(const std::vector<GaussianPose>& poses, double radius);

/** \brief A warning about registrations of which the clouds do not determine every
 * motion; empty if there are none. */
std::string
unmeasuredText(std::size_t num_unmeasured, std::size_t num_registrations);

/** \brief Why a posterior is no edge of a graph; empty if it is. Its pose may be in
 * another basin, for example, where its covariance says nothing. */
std::string
complaintAboutEdge(const Summary& summary);

/** \brief An edge that is no registration of scans. */
constexpr SharedNoise independent_noise{0.0, 0.0};

/** \brief Factor of the variances of a registration with status Doubtful: its standard
 * deviations become three times as large. */
constexpr double doubt_factor = 9.0;

/** \brief The pose of one vertex as seen from another. */
struct GraphEdge {
  int target = 0;
  int source = 0;
  Eigen::Matrix4d T_target_source = Eigen::Matrix4d::Identity();
  /** CovarianceConvention::RightSE3 [m, rad]. */
  Matrix6d covariance = Matrix6d::Identity();
  /** What its error S^1/2 z has in common with other errors:
   * z = sqrt(scan) (n_source - R n_target) + sqrt(common) G d + sqrt(own) n_edge. R is
   * noiseToSource(T_target_source) and d directionOf() it; each n has six independent
   * numbers of variance 1, of a scan and of this edge, and G has 36, of all edges. */
  SharedNoise shared = SharedNoise();

  /** \brief The vertex that is not \p vertex. */
  int
  otherEnd(int vertex) const
  {
    return vertex == target ? source : target;
  }
};

} // namespace bayesian_icp::app
