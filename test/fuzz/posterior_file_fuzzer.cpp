/** \file
 * \brief Fuzzes what pcl_bayesian_icp has written and other tools read: posterior.json
 * and samples.csv.
 */
#include "fuzz_input.h"
#include "io/posterior_file.h"

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  using namespace bayesian_icp;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::isAccepted(
      [&] { io::readPosterior(fuzz::writeInput("posterior.json", bytes)); });
  fuzz::isAccepted([&] {
    const PoseMatrix draws = io::readSamples(fuzz::writeInput("samples.csv", bytes));
    fuzz::require(draws.rows() > 0 && draws.allFinite(), "draws are finite poses");
  });
  return 0;
}
