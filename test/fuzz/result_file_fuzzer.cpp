/** \file
 * \brief Fuzzes files that a batch or an evaluation goes on with: lines of JSON, rows
 * of CSV files.
 */
#include "batch/batch_file.h"
#include "coverage/coverage_study.h"
#include "fuzz_input.h"
#include "paper/paper_runs.h"
#include "samplers/score.h"
#include "sbc/ranks.h"

#include <sstream>
#include <stdexcept>

namespace {

using namespace bayesian_icp;

void
readBatch(const std::string& file)
{
  app::BatchPair pair;
  pair.name = "a";
  pair.settings_id = "b";
  const std::vector<app::BatchPair> pairs = {pair};
  const app::BatchFile batch(file, pairs);
  fuzz::require(batch.remaining().size() <= 1, "a pair is finished or not");
}

/** Read each line of a file as a row. */
template <typename Run>
void
readRows(const std::string& text)
{
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::string row;
    try {
      row = evaluate::rowOf(evaluate::runOf<Run>(line));
    }
    catch (const std::runtime_error&) {
      continue; // not a row
    }
    fuzz::require(evaluate::rowOf(evaluate::runOf<Run>(row)) == row,
                  "rows are read back as written");
  }
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string bytes(fuzz::textOf(data, size));
  fuzz::isAccepted([&] { readBatch(fuzz::writeInput("results", bytes)); });
  fuzz::isAccepted([&] { evaluate::ResultFile(fuzz::writeInput("results", bytes)); });
  fuzz::isAccepted([&] { evaluate::RankFile(fuzz::writeInput("results", bytes)); });
  readRows<evaluate::AccuracyRun>(bytes);
  readRows<evaluate::CoverageRun>(bytes);
  readRows<evaluate::DistributionRun>(bytes);
  readRows<evaluate::RankRun>(bytes);
  readRows<evaluate::ScoredRun>(bytes);
  return 0;
}
