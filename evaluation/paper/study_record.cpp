#include "io/errors.h"
#include "io/json_file.h"
#include "io/numbers.h"
#include "io/output_folder.h"
#include "paper/paper_experiment.h"

#include <pcl/pcl_config.h>

#include <boost/version.hpp>

#include <Eigen/Core>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <thread>

namespace bayesian_icp::evaluate {

namespace {

constexpr char file_name[] = "study.json";
constexpr std::uint64_t max_file_size = 1 << 24;

std::string
processorName()
{
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.compare(0, 10, "model name") == 0)
      return line.substr(line.find(':') + 2);
  return "unknown processor";
}

nlohmann::json
versions()
{
  return {{"pcl_bayesian_icp", BAYESIAN_ICP_VERSION},
          {"compiler", "g++ or compatible " __VERSION__},
          {"PCL", PCL_VERSION_PRETTY},
          {"Eigen",
           std::to_string(EIGEN_WORLD_VERSION) + '.' +
               std::to_string(EIGEN_MAJOR_VERSION) + '.' +
               std::to_string(EIGEN_MINOR_VERSION)},
          {"Boost", BOOST_LIB_VERSION},
          {"processor", processorName()},
          {"cores", std::thread::hardware_concurrency()}};
}

nlohmann::json
recordOf(const PaperStudy& study, const std::vector<PairKey>& pairs, int num_starts)
{
  nlohmann::json record = {{"command", study.command},
                           {"quick", study.options.is_quick},
                           {"seed", study.options.seed},
                           {"seeds", num_starts > 0 ? 1 : study.options.num_repeats},
                           {"skipped_pairs", study.num_skipped},
                           {"pairs", nlohmann::json::array()}};
  if (num_starts > 0)
    record["starts"] = num_starts;
  for (const PairKey& pair : pairs)
    record["pairs"].push_back({{"name", pair.pair}, {"key", pair.key}});
  return record;
}

} // namespace

void
recordExperiment(const PaperStudy& study,
                 const std::string& name,
                 const std::vector<PairKey>& pairs,
                 int num_starts)
{
  const std::string path = study.path(file_name);
  nlohmann::json document = nlohmann::json::object();
  if (std::filesystem::exists(path))
    document = io::readJson(path, max_file_size);
  if (!document.is_object())
    throw io::FileError(path, "is not the record of a study");
  document["versions"] = versions();
  document["experiments"][name] = recordOf(study, pairs, num_starts);
  io::OutputFolder folder(study.options.output_folder);
  folder.add(file_name,
             [&](std::ostream& stream) { stream << document.dump(2) << '\n'; });
  folder.commit();
}

} // namespace bayesian_icp::evaluate
