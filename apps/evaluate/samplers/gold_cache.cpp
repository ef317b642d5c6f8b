#include "gold_cache.h"

#include "input_hash.h"

#include <io/output_folder.h>
#include <io/text_hash.h>

#include <fstream>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

/** To be changed with the moves of the runs or the energy: old files are then ignored.
 */
constexpr char format[] = "bayesian_icp gold standard 1\n";

void
write(std::ostream& stream, double number)
{
  stream.write(reinterpret_cast<const char*>(&number), sizeof number);
}

double
read(std::istream& stream)
{
  double number = 0.0;
  stream.read(reinterpret_cast<char*>(&number), sizeof number);
  if (!stream)
    throw std::runtime_error("the gold standard is cut off");
  return number;
}

/** Numbers of the header, in the order of the file. */
std::vector<double*>
headerOf(GoldStandard& gold)
{
  return {&gold.rhat,
          &gold.kl_between_runs,
          &gold.bulk_ess,
          &gold.tail_ess,
          &gold.acceptance,
          &gold.seconds};
}

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
  hash.add(format, sizeof format);
  hash.addMatrix(problem.scene().source);
  hash.addMatrix(problem.scene().target.points());
  hash.add(problem.energy().weight());
  hash.addMatrix(problem.energy().prior().mean());
  hash.addMatrix(problem.energy().prior().variance());
  hash.addMatrix(problem.energy().prior().referencePoint());
  hash.add(problem.energy().residual().max_distance);
  for (const double number : {static_cast<double>(options.chains_per_run),
                              static_cast<double>(options.steps_per_round),
                              options.max_rhat,
                              options.max_kl,
                              options.min_ess,
                              static_cast<double>(options.seed)})
    hash.add(number);
  return hash.value();
}

void
writeGold(const GoldStandard& gold, std::ostream& stream)
{
  stream << format;
  GoldStandard header = gold;
  for (const double* number : headerOf(header))
    write(stream, *number);
  write(stream, gold.has_converged ? 1.0 : 0.0);
  write(stream, static_cast<double>(gold.chains.size()));
  for (const PoseMatrix& chain : gold.chains) {
    write(stream, static_cast<double>(chain.rows()));
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      for (int k = 0; k < 6; ++k)
        write(stream, chain(i, k));
  }
}

GoldStandard
readGold(std::istream& stream)
{
  std::string first_line(sizeof format - 1, '\0');
  stream.read(first_line.data(), static_cast<std::streamsize>(first_line.size()));
  if (first_line != format)
    throw std::runtime_error("not a gold standard of this version");
  GoldStandard gold;
  for (double* number : headerOf(gold))
    *number = read(stream);
  gold.has_converged = read(stream) != 0.0;
  gold.chains.resize(static_cast<std::size_t>(read(stream)));
  for (PoseMatrix& chain : gold.chains) {
    chain.resize(static_cast<Eigen::Index>(read(stream)), 6);
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      for (int k = 0; k < 6; ++k)
        chain(i, k) = read(stream);
  }
  return gold;
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

} // namespace bayesian_icp::evaluate
