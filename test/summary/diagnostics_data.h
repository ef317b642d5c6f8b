/** \file
 * \brief Reads the stored chains and reference values in data/diagnostics.
 */
#pragma once

#include <Eigen/Core>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace diagnostics_data {

using Rows = std::vector<std::vector<std::string>>;

/** \brief The cells of a file of the diagnostics data, without the heading. */
inline Rows
readCsv(const std::string& name)
{
  std::ifstream file(BAYESIAN_ICP_TEST_DATA_DIR "/diagnostics/" + name + ".csv");
  std::string line;
  if (!std::getline(file, line))
    throw std::runtime_error("no test data " + name);
  Rows rows;
  while (std::getline(file, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      rows.back().push_back(cell);
  }
  return rows;
}

inline double
number(const std::string& cell)
{
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0')
    throw std::runtime_error("not a number: " + cell);
  return value;
}

inline Eigen::MatrixXd
readChains(const std::string& name)
{
  const Rows rows = readCsv(name);
  Eigen::MatrixXd draws(rows.size(), rows.at(0).size());
  for (Eigen::Index draw = 0; draw < draws.rows(); ++draw)
    for (Eigen::Index chain = 0; chain < draws.cols(); ++chain)
      draws(draw, chain) = number(rows[draw].at(chain));
  return draws;
}

inline Eigen::VectorXd
flatten(const Eigen::MatrixXd& draws)
{
  return Eigen::Map<const Eigen::VectorXd>(draws.data(), draws.size());
}

} // namespace diagnostics_data
