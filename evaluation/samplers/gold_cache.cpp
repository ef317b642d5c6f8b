#include "samplers/gold_cache.h"

#include "io/output_folder.h"
#include "io/text_hash.h"
#include "study/input_hash.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace bayesian_icp::evaluate {

namespace {

/** First line of the file, to be changed with the moves of the runs or the energy: old
 * files are then ignored. */
constexpr char gold_format[] = "bayesian_icp gold standard 1\n";

/** Numbers at the beginning of the file, in its order. */
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

void
writeGold(const GoldStandard& gold, std::ostream& stream)
{
  std::vector<double> numbers;
  GoldStandard header = gold;
  for (const double* number : headerOf(header))
    numbers.push_back(*number);
  numbers.push_back(gold.has_converged ? 1.0 : 0.0);
  numbers.push_back(static_cast<double>(gold.chains.size()));
  for (const PoseMatrix& chain : gold.chains) {
    numbers.push_back(static_cast<double>(chain.rows()));
    const auto rows = chain.reshaped<Eigen::RowMajor>();
    numbers.insert(numbers.end(), rows.begin(), rows.end());
  }
  stream << gold_format;
  stream.write(reinterpret_cast<const char*>(numbers.data()),
               static_cast<std::streamsize>(numbers.size() * sizeof(double)));
}

GoldStandard
readGold(std::istream& stream)
{
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::size_t place = sizeof gold_format - 1;
  if (bytes.compare(0, place, gold_format) != 0)
    throw std::runtime_error("not a gold standard of this version");
  const auto read = [&] {
    double number = 0.0;
    if (bytes.size() - place < sizeof number)
      throw std::runtime_error("the gold standard is cut off");
    std::memcpy(&number, &bytes[place], sizeof number);
    place += sizeof number;
    return number;
  };
  // Of things that follow, each of at least so many numbers.
  const auto readCount = [&](std::size_t num_numbers) {
    const double count = read();
    const std::size_t most = (bytes.size() - place) / (num_numbers * sizeof(double));
    if (!(count >= 0.0 && count <= static_cast<double>(most)))
      throw std::runtime_error("the gold standard has a bad count");
    return static_cast<std::size_t>(count);
  };
  GoldStandard gold;
  for (double* number : headerOf(gold))
    *number = read();
  gold.has_converged = read() != 0.0;
  gold.chains.resize(readCount(1));
  for (PoseMatrix& chain : gold.chains) {
    chain.resize(static_cast<Eigen::Index>(readCount(6)), 6);
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      for (int k = 0; k < 6; ++k)
        chain(i, k) = read();
  }
  return gold;
}

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

} // namespace bayesian_icp::evaluate
