/** \file
 * \brief Looking into what a tool wrote: rows of CSV files, pieces of text.
 */
#pragma once

#include "support/command_helpers.h"

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

/** \brief Fields of each line, the header first. */
using Rows = std::vector<std::vector<std::string>>;

/** \brief Read a CSV file without quoting. */
inline Rows
rowsOf(const std::filesystem::path& csv)
{
  Rows rows;
  std::istringstream stream(contentOf(csv));
  for (std::string line; std::getline(stream, line);) {
    auto& row = rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');)
      row.push_back(field);
  }
  return rows;
}

/** \brief Expect a piece of text. */
inline void
expectIn(const std::string& text, const std::string& piece)
{
  EXPECT_NE(text.find(piece), std::string::npos) << piece << " is not in: " << text;
}

/** \brief How often a piece is in a text. */
inline int
count(const std::string& piece, const std::string& text)
{
  int found = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos;
       at = text.find(piece, at + 1))
    ++found;
  return found;
}
