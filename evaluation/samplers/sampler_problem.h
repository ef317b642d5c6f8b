/** \file
 * \brief A pair of scans and the posteriors ("cells") that are sampled on it, with
 * their gold standards, which are kept on disk so that one is made once for the same
 * inputs.
 */
#pragma once

#include "exact/pose_energy.h"
#include "samplers/gold_standard.h"

#include <bayesian_icp/kd_tree.h>
#include <bayesian_icp/options.h>

#include <string>

namespace bayesian_icp::evaluate {

/** \brief Scale of the likelihood. */
struct Cell {
  /** sigma [m] and N of LikelihoodScale. */
  double sigma;
  double effective_points;
};

/** \brief Two scans, the source thinned. */
struct Scene {
  std::string name;
  /** 3 x n, finite, source frame [m]. */
  Eigen::Matrix3Xd source;
  KdTree target;
};

/** \brief Read FOLDER/NAME/source.pcd and target.pcd.
 * \param[in] max_points the source is thinned evenly to this number
 * \throws io::FileError */
Scene
readScene(const std::string& folder, const std::string& name, std::size_t max_points);

/** \brief The posterior of a scene at a cell: preset `exact` with a residual and the
 * default prior about the identity. */
class Problem {
public:
  /** \p scene must outlive this object. */
  Problem(const Scene& scene,
          const Cell& cell,
          Residual residual = Residual::PointToPoint);
  Problem(const Problem&) = delete;
  Problem&
  operator=(const Problem&) = delete;

  /** \brief Options with the likelihood, and starts as wide as the prior, or +-5 cm and
   * +-0.1 rad for tight cells; 4 chains, 2000 draws. */
  Options
  options(Preset preset) const;

  /** \brief Density of the centred pose phi of PoseEnergy, angles within half a turn:
   * beyond, everything comes again. */
  GoldTarget
  goldTarget() const;

  /** \brief Its energy and gradient, for one chain. */
  GradientFunction
  makeGradient() const;

  const PoseEnergy&
  energy() const
  {
    return energy_;
  }

  const Scene&
  scene() const
  {
    return scene_;
  }

  /** \brief The scene's name, and the residual's unless it is point-to-point. */
  std::string
  name() const;

  const Cell&
  cell() const
  {
    return cell_;
  }

private:
  Vector6d
  startSpread() const;

  const Scene& scene_;
  Cell cell_;
  ResidualOptions residual_;
  TreeTarget target_;
  PoseEnergy energy_;
};

/** \brief Read the gold standard of \p problem from \p folder, or make it and write it
 * there. One that had not converged is made again if more time is allowed now. Its
 * draws are poses theta, not canonical (angles within half a turn).
 * \param[in] report gets a line now and then
 * \throws io::FileError if the folder cannot be written */
GoldStandard
cachedGold(const Problem& problem,
           const GoldOptions& options,
           const std::string& folder,
           const std::function<void(const std::string&)>& report);

/** \brief What tells rows of this gold standard from rows of others: a hash of what it
 * depends on, and the draws themselves of one that has not converged, which may become
 * another one. */
std::string
rowKey(const Problem& problem, const GoldOptions& options, const GoldStandard& gold);

} // namespace bayesian_icp::evaluate
