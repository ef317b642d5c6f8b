#include "register/output_files.h"

#include "io/numbers.h"
#include "io/posterior_file.h"
#include "register/posterior_json.h"

#include <ostream>

namespace bayesian_icp::app {

void
writeSamples(const std::vector<Chain>& chains, std::ostream& stream)
{
  stream << io::samples_header << '\n';
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (chains[i].diverged)
      continue;
    for (Eigen::Index draw = 0; draw < chains[i].draws.rows(); ++draw) {
      std::string line = io::textOf(i) + ',' + io::textOf(draw);
      for (int k = 0; k < 6; ++k)
        line += ',' + io::textOf(chains[i].draws(draw, k), 17);
      stream << line << '\n';
    }
  }
}

void
addPosteriorFiles(const Run& run, io::OutputFolder& folder)
{
  folder.add("samples.csv",
             [&](std::ostream& stream) { writeSamples(run.result.chains, stream); });
  folder.add("posterior.json", posteriorJson(run));
}

} // namespace bayesian_icp::app
