/** \file
 * \brief A CSV file that grows by one row per run, so an interrupted study continues
 * where it stopped.
 */
#pragma once

#include "io/line_file.h"

#include <functional>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief Rows of text below a header, written by one process at a time. */
class RowFile {
public:
  /** \brief Read what is there, or write the header; a last line that was cut off is
   * removed.
   * \param[in] read_row gets each row; throws any std::exception if it is not one
   * \throws io::FileError if the file exists and has another header or a bad row, or
   *         cannot be written, or is in use by another process */
  RowFile(const std::string& name,
          const std::string& header,
          const std::function<void(const std::string& row)>& read_row);

  /** \brief Write a row, at once.
   * \throws io::FileError */
  void
  add(const std::string& row) const;

private:
  io::LineFile file_;
};

} // namespace bayesian_icp::evaluate
