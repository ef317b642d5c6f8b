#include "samplers/gold_file.h"

#include <istream>
#include <ostream>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

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

std::size_t
numBytesLeft(std::istream& stream)
{
  const std::istream::pos_type here = stream.tellg();
  const std::istream::pos_type end = stream.seekg(0, std::ios::end).tellg();
  stream.seekg(here);
  return static_cast<std::size_t>(end - here);
}

/** A number of things that follow, at most \p max_count.
 * \throws std::runtime_error if it is none */
std::size_t
readCount(std::istream& stream, std::size_t max_count)
{
  const double count = read(stream);
  if (!(count >= 0.0 && count <= static_cast<double>(max_count)))
    throw std::runtime_error("the gold standard has a bad count");
  return static_cast<std::size_t>(count);
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

} // namespace

void
writeGold(const GoldStandard& gold, std::ostream& stream)
{
  stream << gold_format;
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
  std::string first_line(sizeof gold_format - 1, '\0');
  stream.read(first_line.data(), static_cast<std::streamsize>(first_line.size()));
  if (first_line != gold_format)
    throw std::runtime_error("not a gold standard of this version");
  const std::size_t max_numbers = numBytesLeft(stream) / sizeof(double);
  GoldStandard gold;
  for (double* number : headerOf(gold))
    *number = read(stream);
  gold.has_converged = read(stream) != 0.0;
  gold.chains.resize(readCount(stream, max_numbers));
  for (PoseMatrix& chain : gold.chains) {
    chain.resize(static_cast<Eigen::Index>(readCount(stream, max_numbers / 6)), 6);
    for (Eigen::Index i = 0; i < chain.rows(); ++i)
      for (int k = 0; k < 6; ++k)
        chain(i, k) = read(stream);
  }
  return gold;
}

} // namespace bayesian_icp::evaluate
