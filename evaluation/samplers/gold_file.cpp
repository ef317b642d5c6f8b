#include "samplers/gold_file.h"

#include <cstring>
#include <istream>
#include <iterator>
#include <ostream>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

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

} // namespace bayesian_icp::evaluate
