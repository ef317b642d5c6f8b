#include "samplers/score.h"

#include <sstream>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

const std::string header =
    std::string("gold_key,scene,sigma,effective_points,sampler,seed,status,") +
    score_columns + ",min_ess_per_second";
constexpr std::size_t num_columns = 32;

std::string
rowOf(const ScoredRun& run)
{
  std::ostringstream row;
  row << run.name.gold_key << ',' << run.name.scene << ',' << run.name.sigma << ','
      << run.name.effective_points << ',' << run.name.sampler << ',' << run.name.seed
      << ',' << run.score.status;
  forEachNumber(run.score, [&row](double number) { row << ',' << number; });
  row << ',' << run.score.essPerSecond();
  return row.str();
}

/** \throws std::exception if the line is not a row */
ScoredRun
runOf(const std::string& line)
{
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');)
    fields.push_back(field);
  if (fields.size() != num_columns)
    throw std::runtime_error("wrong number of columns");
  ScoredRun run;
  run.name = {fields[1],
              std::stod(fields[2]),
              std::stod(fields[3]),
              fields[4],
              std::stoull(fields[5]),
              fields[0]};
  run.score.status = fields[6];
  std::size_t column = 7;
  forEachNumber(run.score,
                [&](double& number) { number = std::stod(fields[column++]); });
  return run;
}

bool
isSame(const RunName& a, const RunName& b)
{
  return a.gold_key == b.gold_key && a.sampler == b.sampler && a.seed == b.seed;
}

} // namespace

ResultFile::ResultFile(const std::string& name)
: file_(name, header, [this](const std::string& row) { runs_.push_back(runOf(row)); })
{}

const ScoredRun*
ResultFile::find(const RunName& name) const
{
  for (const ScoredRun& run : runs_)
    if (isSame(run.name, name))
      return &run;
  return nullptr;
}

void
ResultFile::add(const ScoredRun& run)
{
  file_.add(rowOf(run));
  runs_.push_back(run);
}

} // namespace bayesian_icp::evaluate
