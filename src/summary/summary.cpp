#include "summary/estimates.h"
#include "summary/plain_text.h"

#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/summary.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** Draws that are turned further from their mean have no barycentre on SE(3) [rad]: any
 * of them, as the rotation vector jumps at half a turn, and in root mean square. */
constexpr double max_turn = 3.0;
constexpr double max_rms_turn = 1.0;
/** Steps towards the barycentre, and the last one: in radians, and in metres as a share
 * of the lengths that it is made of. */
constexpr int max_steps = 30;
constexpr double max_last_step = 1e-12;

PoseMatrix
errorsAbout(const Vector6d& mean,
            const PoseMatrix& draws,
            CovarianceConvention convention)
{
  PoseMatrix errors(draws.rows(), 6);
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    errors.row(i) = poseError(draws.row(i).transpose(), mean, convention).transpose();
  return errors;
}

/** The pose of the draws' mean matrix. */
Vector6d
chordalMean(const PoseMatrix& draws)
{
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < draws.rows(); ++i)
    sum += matrixOf(draws.row(i).transpose());
  return poseOf(sum / static_cast<double>(draws.rows()));
}

/** Move \p mean to the pose about which the draws' twists have the mean zero.
 * \return whether there is one */
bool
moveToBarycentre(const PoseMatrix& draws, Vector6d& mean)
{
  constexpr auto convention = CovarianceConvention::RightSE3;
  for (int i = 0; i < max_steps; ++i) {
    const PoseMatrix errors = errorsAbout(mean, draws, convention);
    const Eigen::VectorXd squared_turns = errors.rightCols<3>().rowwise().squaredNorm();
    if (!(squared_turns.mean() <= max_rms_turn * max_rms_turn && // nor for NaN
          squared_turns.maxCoeff() <= max_turn * max_turn))
      return false;
    const Vector6d step = errors.colwise().mean().transpose();
    const double length =
        mean.head<3>().norm() + errors.leftCols<3>().rowwise().norm().mean();
    mean = poseFromError(step, mean, convention);
    if (step.head<3>().norm() <= max_last_step * length &&
        step.tail<3>().norm() <= max_last_step)
      return true;
  }
  return false;
}

std::vector<const Chain*>
usableChains(const std::vector<Chain>& chains)
{
  std::vector<const Chain*> usable;
  for (const auto& chain : chains)
    if (!chain.diverged)
      usable.push_back(&chain);
  return usable;
}

/** Errors of coordinate \p k about \p means, (draws that every chain has) x (chains).
 */
Eigen::MatrixXd
coordinateErrors(const Vector6d& means, const std::vector<const Chain*>& chains, int k)
{
  Eigen::Index num_draws = chains.empty() ? 0 : chains.front()->draws.rows();
  for (const auto* chain : chains)
    num_draws = std::min(num_draws, chain->draws.rows());
  Eigen::MatrixXd errors(num_draws, static_cast<Eigen::Index>(chains.size()));
  for (Eigen::Index c = 0; c < errors.cols(); ++c)
    for (Eigen::Index i = 0; i < num_draws; ++i) {
      const double error = chains[static_cast<std::size_t>(c)]->draws(i, k) - means[k];
      errors(i, c) = k < 3 ? error : wrapAngle(error);
    }
  return errors;
}

void
summarizeCoordinate(const Eigen::VectorXd& errors,
                    const Eigen::MatrixXd& errors_by_chain,
                    CoordinateSummary& coordinate)
{
  if (errors.size() > 1)
    coordinate.standard_deviation =
        std::sqrt(errors.squaredNorm() / static_cast<double>(errors.size() - 1));
  coordinate.quantile_2_5 = coordinate.mean + quantile(errors, 0.025);
  coordinate.median = coordinate.mean + quantile(errors, 0.5);
  coordinate.quantile_97_5 = coordinate.mean + quantile(errors, 0.975);
  if (errors_by_chain.size() == 0)
    return;
  coordinate.rhat = rhat(errors_by_chain);
  coordinate.bulk_ess = bulkEss(errors_by_chain);
  coordinate.tail_ess = tailEss(errors_by_chain);
  coordinate.mcse = mcseMean(errors_by_chain);
}

/** The modes of \p chain_set that have draws, heaviest first. */
std::vector<Mode>
summarizeModes(const ChainSet& chain_set)
{
  std::vector<Mode> modes;
  double sum = 0.0;
  for (const auto& chains : chain_set.modes) {
    const PoseMatrix draws = drawsOf(chains, chain_set.chains);
    if (draws.rows() == 0)
      continue;
    Mode mode;
    mode.chains = chains.members;
    mode.mean = meanPose(draws);
    for (const auto convention : covariance_conventions)
      mode.covariances[static_cast<std::size_t>(convention)] =
          covarianceAbout(mode.mean, draws, convention);
    mode.weight = std::exp(chains.log_evidence - chain_set.modes.front().log_evidence);
    sum += mode.weight;
    modes.push_back(mode);
  }
  for (auto& mode : modes)
    mode.weight /= sum;
  std::stable_sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) {
    return a.weight > b.weight;
  });
  return modes;
}

/** The worst diagnostics over the coordinates; NaN as soon as one is undefined. */
struct WorstDiagnostics {
  double rhat = 0.0;
  double ess = std::numeric_limits<double>::infinity();

  explicit WorstDiagnostics(const Summary& summary)
  {
    for (const auto& coordinate : summary.coordinates) {
      if (!(coordinate.rhat <= rhat))
        rhat = coordinate.rhat;
      const double coordinate_ess =
          std::isnan(coordinate.bulk_ess)
              ? coordinate.bulk_ess
              : std::min(coordinate.tail_ess, coordinate.bulk_ess);
      if (!(coordinate_ess >= ess))
        ess = coordinate_ess;
      if (std::isnan(rhat) || std::isnan(ess))
        return;
    }
  }
};

Status
statusOf(const Summary& summary, const ChainSet& set, const WorstDiagnostics& worst)
{
  if (summary.num_diverged_chains > 0)
    return Status::Diverged;
  if (set.cancelled)
    return Status::Cancelled;
  if (summary.modes.size() > 1)
    return Status::SeveralModes;
  if (set.particles)
    return set.particles->discrepancy <= max_stein_discrepancy ? Status::Ok
                                                               : Status::NotMixed;
  if (worst.rhat <= max_rhat && worst.ess >= min_ess)
    return Status::Ok;
  return Status::NotMixed;
}

std::string
particlesMessage(const ParticleReport& particles, Status status)
{
  const bool is_good = status == Status::Ok;
  return formatted("the particles %s after %d steps: kernelised Stein discrepancy %.3f "
                   "(at most %.3f is good), variance %.2f of what the gradients ask "
                   "for; particles have no R-hat%s",
                   is_good ? "converged" : "did not converge to the posterior",
                   particles.num_steps,
                   particles.discrepancy,
                   max_stein_discrepancy,
                   particles.variance_share,
                   is_good ? ""
                           : "; mean and covariance describe them, not reliably the "
                             "posterior");
}

std::string
modesMessage(const Summary& summary)
{
  std::string text =
      "the chains found " + std::to_string(summary.modes.size()) + " modes, of weight";
  for (const auto& mode : summary.modes)
    text += formatted(" %.3f", mode.weight);
  return text + "; mean and covariance mix them";
}

/** Addition to a message if chains were moved to a better mode. */
std::string
movedMessage(const ChainSet& chain_set)
{
  if (chain_set.num_moved_chains == 0)
    return "";
  return formatted("; %d of %d chains had ended in a mode at least %.0f nats worse and "
                   "were moved to the best one",
                   chain_set.num_moved_chains,
                   static_cast<int>(chain_set.chains.size()),
                   chain_set.moved_by_nats);
}

/** Whether the draws are too few for the diagnostics, or the chains agree and would
 * pass with more draws of the same kind. */
bool
areTooFewDraws(const Summary& summary, const WorstDiagnostics& worst)
{
  const auto num_draws = static_cast<double>(summary.num_draws);
  // So few draws of a chain have neither, however many chains there are.
  constexpr double few_of_a_chain = 10.0;
  if (std::isnan(worst.rhat) || std::isnan(worst.ess))
    return num_draws < min_ess || num_draws < few_of_a_chain * summary.num_chains;
  // Gelman and Rubin's (1992) limit, and the effective share of the draws with which
  // the default number passes.
  constexpr double short_rhat = 1.1;
  const double share = min_ess / ChainOptions().num_draws;
  return worst.rhat < short_rhat && worst.ess < min_ess &&
         worst.ess > share * num_draws;
}

std::string
messageOf(const Summary& summary, const ChainSet& set, const WorstDiagnostics& worst)
{
  if (set.particles &&
      (summary.status == Status::Ok || summary.status == Status::NotMixed))
    return particlesMessage(*set.particles, summary.status);
  switch (summary.status) {
  case Status::SeveralModes:
    return modesMessage(summary);
  case Status::Diverged:
    return formatted(
        "%d of %d chains diverged (ran away from the prior, jumped about or became "
        "non-finite) and are left out; a smaller step size or a larger maximum "
        "correspondence distance may help",
        summary.num_diverged_chains,
        summary.num_chains);
  case Status::Cancelled:
    return formatted("interrupted after %ld draws", summary.num_draws);
  case Status::Ok:
    return formatted(
        "the chains mixed: largest R-hat %.4f, smallest effective sample size "
        "%.0f",
        worst.rhat,
        worst.ess);
  default:
    if (areTooFewDraws(summary, worst))
      return formatted(
          "%ld draws are too few to tell whether the chains mixed: every "
          "effective sample size has to be at least %.0f, take %d draws or "
          "more, with several hundred of each chain; mean and covariance describe "
          "these draws, not reliably the posterior",
          summary.num_draws,
          min_ess,
          ChainOptions().num_draws);
    return formatted(
        "the chains did not mix: largest R-hat %.3f (at most %.2f is good), "
        "smallest effective sample size %.0f (at least %.0f is good); mean and "
        "covariance describe these draws, not reliably the posterior",
        worst.rhat,
        max_rhat,
        worst.ess,
        min_ess);
  }
}

} // namespace

Mode::Mode()
{
  covariances.fill(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

const Matrix6d&
Mode::covariance(CovarianceConvention convention) const
{
  return covariances[static_cast<std::size_t>(convention)];
}

Summary::Summary()
{
  covariances.fill(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

const Matrix6d&
Summary::covariance(CovarianceConvention convention) const
{
  return covariances[static_cast<std::size_t>(convention)];
}

PoseMatrix
pooledDraws(const std::vector<Chain>& chains)
{
  Eigen::Index num_draws = 0;
  for (const auto* chain : usableChains(chains))
    num_draws += chain->draws.rows();
  PoseMatrix pooled(num_draws, 6);
  Eigen::Index row = 0;
  for (const auto* chain : usableChains(chains)) {
    pooled.middleRows(row, chain->draws.rows()) = chain->draws;
    row += chain->draws.rows();
  }
  return pooled;
}

PoseMatrix
drawsOf(const ChainMode& mode, const std::vector<Chain>& chains)
{
  std::vector<Chain> members;
  for (const int i : mode.members)
    members.push_back(chains[static_cast<std::size_t>(i)]);
  return pooledDraws(members);
}

Vector6d
coordinateMeans(const PoseMatrix& draws)
{
  if (draws.rows() == 0)
    return Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector6d means = draws.colwise().mean().transpose();
  for (int k = 3; k < 6; ++k)
    means[k] = std::atan2(draws.col(k).array().sin().mean(),
                          draws.col(k).array().cos().mean());
  return means;
}

Vector6d
meanPose(const PoseMatrix& draws)
{
  Vector6d mean = chordalMean(draws);
  return draws.rows() > 0 && moveToBarycentre(draws, mean) ? mean
                                                           : coordinateMeans(draws);
}

Matrix6d
covarianceAbout(const Vector6d& mean,
                const PoseMatrix& draws,
                CovarianceConvention convention)
{
  if (draws.rows() < 2)
    return Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN());
  const PoseMatrix errors = errorsAbout(mean, draws, convention);
  return errors.transpose() * errors / static_cast<double>(draws.rows() - 1);
}

Summary
summarize(const ChainSet& chain_set)
{
  const auto chains = usableChains(chain_set.chains);
  const PoseMatrix draws = pooledDraws(chain_set.chains);

  Summary summary;
  summary.num_chains = static_cast<int>(chain_set.chains.size());
  summary.num_diverged_chains = summary.num_chains - static_cast<int>(chains.size());
  summary.num_draws = draws.rows();
  summary.mean = meanPose(draws);
  for (const auto convention : covariance_conventions)
    summary.covariances[static_cast<std::size_t>(convention)] =
        covarianceAbout(summary.mean, draws, convention);

  const Vector6d means = coordinateMeans(draws);
  const PoseMatrix errors = errorsAbout(means, draws, CovarianceConvention::Parameters);
  for (int k = 0; k < 6; ++k) {
    auto& coordinate = summary.coordinates[static_cast<std::size_t>(k)];
    coordinate.mean = means[k];
    summarizeCoordinate(errors.col(k),
                        chain_set.particles ? Eigen::MatrixXd()
                                            : coordinateErrors(means, chains, k),
                        coordinate);
  }
  summary.modes = summarizeModes(chain_set);
  const WorstDiagnostics worst(summary);
  summary.status = statusOf(summary, chain_set, worst);
  summary.message = messageOf(summary, chain_set, worst) + movedMessage(chain_set);
  return summary;
}

} // namespace bayesian_icp
