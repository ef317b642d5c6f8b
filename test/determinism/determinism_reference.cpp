// Writes the numbers of the runs of determinism_runs.h to files, or compares them with
// such files. Files are written by whoever changes an algorithm on purpose.
#include "determinism_runs.h"

#include <nlohmann/json.hpp>

#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>

namespace bayesian_icp::test {
namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <typename Row>
Json
jsonOfRow(const Row& row)
{
  Json numbers = Json::array();
  for (Eigen::Index k = 0; k < row.size(); ++k)
    numbers.push_back(row[k]); // NaN becomes null
  return numbers;
}

Json
jsonOf(const std::string& name, const RunRecord& record)
{
  Json document;
  document["run"] = name;
  document["outcome"] = record.outcome;
  document["unit"] = jsonOfRow(record.unit);
  for (const PoseTable& table : record.tables)
    for (Eigen::Index i = 0; i < table.rows.rows(); ++i)
      document["poses"][table.name].push_back(jsonOfRow(table.rows.row(i)));
  return document;
}

Vector6d
rowOf(const Json& numbers)
{
  Vector6d row;
  for (std::size_t k = 0; k < 6; ++k)
    row[static_cast<Eigen::Index>(k)] =
        numbers.at(k).is_null() ? nan : numbers.at(k).get<double>();
  return row;
}

RunRecord
recordOf(const Json& document)
{
  RunRecord record;
  record.outcome = document.at("outcome").get<std::string>();
  record.unit = rowOf(document.at("unit"));
  for (const auto& [name, rows] : document.at("poses").items()) {
    PoseTable table{name, PoseMatrix(static_cast<Eigen::Index>(rows.size()), 6)};
    for (std::size_t i = 0; i < rows.size(); ++i)
      table.rows.row(static_cast<Eigen::Index>(i)) = rowOf(rows[i]).transpose();
    record.tables.push_back(table);
  }
  return record;
}

/** One line for each row of numbers, so that a change of one is a change of a line. */
std::string
textOf(const Json& document)
{
  std::string text = "{\n";
  for (const char* key : {"run", "outcome", "unit"})
    text += "  \"" + std::string(key) + "\": " + document[key].dump() + ",\n";
  text += "  \"poses\": {";
  const char* comma = "\n";
  for (const auto& [name, rows] : document["poses"].items()) {
    text += comma + ("    \"" + name + "\": [");
    for (std::size_t i = 0; i < rows.size(); ++i)
      text += (i == 0 ? "\n      " : ",\n      ") + rows[i].dump();
    text += "\n    ]";
    comma = ",\n";
  }
  return text + "\n  }\n}\n";
}

bool
write(const std::string& path, const std::string& name)
{
  std::ofstream file(path);
  file << textOf(jsonOf(name, makeRun(name)));
  file.close();
  if (!file)
    std::cerr << path << ": cannot be written\n";
  return static_cast<bool>(file);
}

bool
check(const std::string& path, const std::string& name)
{
  std::ifstream file(path);
  if (!file) {
    std::cerr << path << ": cannot be read\n";
    return false;
  }
  const RunRecord reference = recordOf(Json::parse(file)), record = makeRun(name);
  const double found = difference(reference, record);
  const bool is_same = found <= rounding_tolerance;
  std::cout << name << ": " << (is_same ? "as stored" : "NOT AS STORED")
            << ", largest difference " << found << " units, " << rounding_tolerance
            << " are rounding; outcome " << record.outcome << '\n';
  if (reference.outcome != record.outcome)
    std::cout << name << ": the stored outcome is " << reference.outcome << '\n';
  return is_same;
}

int
run(const std::string& action, const std::string& folder)
{
  if (action != "--write" && action != "--check") {
    std::cerr << "Usage: determinism_reference --write|--check FOLDER\n";
    return 2;
  }
  bool all_well = true;
  for (const std::string& name : runNames()) {
    const std::string path = std::filesystem::path(folder) / (name + ".json");
    all_well =
        (action == "--write" ? write(path, name) : check(path, name)) && all_well;
  }
  if (!all_well && action == "--check")
    std::cout << "If the algorithm was changed on purpose, write the files anew:\n"
                 "  build/bin/determinism_reference --write test/data/determinism\n";
  return all_well ? 0 : 1;
}

} // namespace
} // namespace bayesian_icp::test

int
main(int argc, char** argv)
try {
  return bayesian_icp::test::run(argc == 3 ? argv[1] : "", argc == 3 ? argv[2] : "");
}
catch (const std::exception& error) {
  std::cerr << "determinism_reference: " << error.what() << '\n';
  return 1;
}
