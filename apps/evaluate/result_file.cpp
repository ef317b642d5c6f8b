#include "score.h"

#include <sstream>
#include <stdexcept>

namespace bayesian_icp::evaluate {

namespace {

constexpr char header[] =
    "gold_key,scene,sigma,effective_points,sampler,seed,status,kl,"
    "kl_x,kl_y,kl_z,kl_roll,kl_pitch,kl_yaw,w1_x,w1_y,w1_z,w1_roll,w1_pitch,w1_yaw,"
    "ks_x,ks_y,ks_z,ks_roll,ks_pitch,ks_yaw,rhat,bulk_ess,tail_ess,seconds,draws,"
    "min_ess_per_second";
constexpr std::size_t num_columns = 32;

/** Numbers of a score in the order of the columns from kl to draws. */
template <typename ScoreType, typename Visit>
void
forEachNumber(ScoreType& score, const Visit& visit)
{
  visit(score.kl);
  for (auto* vector :
       {&score.coordinate_kl, &score.wasserstein, &score.kolmogorov_smirnov})
    for (int k = 0; k < 6; ++k)
      visit((*vector)[k]);
  visit(score.rhat);
  visit(score.bulk_ess);
  visit(score.tail_ess);
  visit(score.seconds);
  visit(score.num_draws);
}

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
