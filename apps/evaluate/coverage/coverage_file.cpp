#include "coverage_file.h"

#include <io/numbers.h>

#include <stdexcept>
#include <tuple>

namespace bayesian_icp::evaluate {

namespace {

constexpr char columns[] =
    "scene,condition,seed,method,valid,nees,region,log_score,energy_score,"
    "pit_vx,pit_vy,pit_vz,pit_wx,pit_wy,pit_wz,z_vx,z_vy,z_vz,z_wx,z_wy,z_wz,"
    "relative_sd_vx,relative_sd_vy,relative_sd_vz,"
    "relative_sd_wx,relative_sd_wy,relative_sd_wz,"
    "translation_error_m,rotation_error_rad,seconds,queries,notes";
constexpr std::size_t num_columns = 32;

/** Numbers of a score in the order of the columns from nees to queries. */
template <typename ScoreType, typename Visit>
void
forEachNumber(ScoreType& score, const Visit& visit)
{
  visit(score.nees);
  visit(score.region);
  visit(score.log_score);
  visit(score.energy_score);
  for (auto* vector : {&score.pit, &score.z, &score.relative_sd})
    for (int k = 0; k < 6; ++k)
      visit((*vector)[k]);
  visit(score.translation_error);
  visit(score.rotation_error);
  visit(score.seconds);
  visit(score.num_queries);
}

/** A text that fits into a field. */
std::string
fieldOf(std::string text)
{
  for (char& character : text)
    if (character == ',' || static_cast<unsigned char>(character) < 0x20)
      character = ' ';
  return text;
}

template <typename Number>
void
readField(std::string_view field, Number& number)
{
  if (!io::readNumber(field, number))
    throw std::runtime_error("not a number");
}

} // namespace

bool
CoverageRunName::operator<(const CoverageRunName& other) const
{
  return std::tie(scene, condition, seed, method) <
         std::tie(other.scene, other.condition, other.seed, other.method);
}

std::string
CoverageRun::header()
{
  return columns;
}

std::string
CoverageRun::row() const
{
  std::string row = fieldOf(name.scene) + ',' + fieldOf(name.condition) + ',' +
                    io::textOf(name.seed) + ',' + fieldOf(name.method) +
                    (score.is_valid ? ",1" : ",0");
  forEachNumber(score, [&row](auto number) { row += ',' + io::textOf(number); });
  return row + ',' + fieldOf(score.notes);
}

CoverageRun
CoverageRun::ofRow(const std::string& line)
{
  const auto fields = io::splitAt(',', line);
  if (fields.size() != num_columns || (fields[4] != "0" && fields[4] != "1"))
    throw std::runtime_error("not a row");
  CoverageRun run;
  run.name = {
      std::string(fields[0]), std::string(fields[1]), 0, std::string(fields[3])};
  readField(fields[2], run.name.seed);
  run.score.is_valid = fields[4] == "1";
  std::size_t column = 5;
  forEachNumber(run.score, [&](auto& number) { readField(fields[column++], number); });
  run.score.notes = std::string(fields.back());
  return run;
}

} // namespace bayesian_icp::evaluate
