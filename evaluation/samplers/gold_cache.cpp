#include "samplers/gold_cache.h"

#include "io/output_folder.h"
#include "io/text_hash.h"
#include "samplers/gold_file.h"
#include "study/input_hash.h"

#include <fstream>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

bool
readFile(const std::string& name, GoldStandard& gold)
{
  std::ifstream stream(name, std::ios::binary);
  if (!stream)
    return false;
  try {
    gold = readGold(stream);
  }
  catch (const std::runtime_error&) {
    return false; // not one of ours, or of an older version: made again
  }
  return true;
}

void
toTheta(const Problem& problem, GoldStandard& gold)
{
  for (PoseMatrix& chain : gold.chains)
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      chain.row(i) = problem.energy().toTheta(chain.row(i).transpose()).transpose();
}

} // namespace

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

GoldStandard
cachedGold(const Problem& problem,
           const GoldOptions& options,
           const std::string& folder,
           const std::function<void(const std::string&)>& report)
{
  const std::string name = "gold_" + io::textOfHash(goldKey(problem, options)) + ".bin";
  GoldStandard gold;
  if (readFile(folder + "/" + name, gold) &&
      (gold.has_converged || gold.seconds >= options.max_seconds))
    return gold;
  io::OutputFolder output(folder);
  gold = sampleGold(problem.goldTarget(), options, report);
  toTheta(problem, gold);
  output.add(name, [&gold](std::ostream& stream) { writeGold(gold, stream); });
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
