#include "samplers/gold_cache.h"

#include "io/output_folder.h"
#include "io/text_hash.h"
#include "study/input_hash.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <vector>

namespace bayesian_icp::evaluate {

namespace {

/** To be changed with the moves of the runs or the energy: old files are then ignored.
 */
constexpr char gold_format[] = "bayesian_icp gold standard 2";

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/** Draws, and what tells whether more time would make them better. */
std::vector<std::uint8_t>
bytesOf(const GoldStandard& gold)
{
  auto chains = nlohmann::json::array();
  for (const PoseMatrix& chain : gold.chains) {
    const Rows rows = chain;
    chains.push_back(std::vector<double>(rows.data(), rows.data() + rows.size()));
  }
  return nlohmann::json::to_cbor({{"format", gold_format},
                                  {"has_converged", gold.has_converged},
                                  {"seconds", gold.seconds},
                                  {"chains", chains}});
}

bool
readFile(const std::string& name, GoldStandard& gold)
{
  std::ifstream stream(name, std::ios::binary);
  if (!stream)
    return false;
  try {
    const auto json = nlohmann::json::from_cbor(stream);
    if (json.at("format") != gold_format)
      return false;
    gold.has_converged = json.at("has_converged");
    gold.seconds = json.at("seconds");
    for (const auto& chain : json.at("chains")) {
      const auto numbers = chain.get<std::vector<double>>();
      gold.chains.push_back(Eigen::Map<const Rows>(
          numbers.data(), static_cast<Eigen::Index>(numbers.size() / 6), 6));
    }
  }
  catch (const nlohmann::json::exception&) {
    return false; // not one of ours, or cut off: made again
  }
  return !gold.chains.empty();
}

void
toTheta(const Problem& problem, GoldStandard& gold)
{
  for (PoseMatrix& chain : gold.chains)
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      chain.row(i) = problem.energy().toTheta(chain.row(i).transpose()).transpose();
}

/** What a gold standard depends on, in one number: points, likelihood, prior, options
 * of its runs. The number of threads and of seconds are left out. */
std::uint64_t
goldKey(const Problem& problem, const GoldOptions& options)
{
  InputHash hash;
  hash.add(gold_format, sizeof gold_format);
  hash.addMatrix(problem.scene().source);
  hash.addMatrix(problem.scene().target.points());
  hash.add(problem.energy().weight());
  hash.addMatrix(problem.energy().prior().mean());
  hash.addMatrix(problem.energy().prior().variance());
  hash.addMatrix(problem.energy().prior().referencePoint());
  hash.add(problem.energy().residual().max_distance);
  if (problem.energy().residual().residual != Residual::PointToPoint)
    hash.add(static_cast<double>(problem.energy().residual().residual));
  for (const double number : {static_cast<double>(options.chains_per_run),
                              static_cast<double>(options.steps_per_round),
                              options.max_rhat,
                              options.max_kl,
                              options.min_ess,
                              static_cast<double>(options.seed)})
    hash.add(number);
  return hash.value();
}

} // namespace

GoldStandard
cachedGold(const Problem& problem,
           const GoldOptions& options,
           const std::string& folder,
           const std::function<void(const std::string&)>& report)
{
  const std::string name =
      "gold_" + io::textOfHash(goldKey(problem, options)) + ".cbor";
  GoldStandard gold;
  if (readFile(folder + "/" + name, gold) &&
      (gold.has_converged || gold.seconds >= options.max_seconds))
    return gold;
  io::OutputFolder output(folder);
  gold = sampleGold(problem.goldTarget(), options, report);
  toTheta(problem, gold);
  const std::vector<std::uint8_t> bytes = bytesOf(gold);
  output.add(name, std::string(bytes.begin(), bytes.end()));
  output.commit();
  return gold;
}

std::string
rowKey(const Problem& problem, const GoldOptions& options, const GoldStandard& gold)
{
  InputHash hash;
  const std::uint64_t inputs = goldKey(problem, options);
  hash.add(&inputs, sizeof inputs);
  for (const PoseMatrix& chain : gold.chains)
    hash.addMatrix(chain);
  return io::textOfHash(gold.has_converged ? inputs : hash.value());
}

} // namespace bayesian_icp::evaluate
