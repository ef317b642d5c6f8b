/** \file
 * \brief The lines of JSON that the pairs of a batch end in, and the file of them,
 * which one or several processes write.
 */
#pragma once

#include "batch/batch_run.h"
#include "io/line_file.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace bayesian_icp::app {

/** \brief The line of a pair, without a line break. The parts are those of
 * posterior.json; of the covariances, `parameters` and `right_se3`. A pair that could
 * not be registered has status "error" and the same keys. */
std::string
batchLine(const BatchResult& result);

/** \brief FILE with one line per pair, and FILE.rank1, FILE.rank2, ... in which other
 * processes of a running batch put their lines. Whatever was killed at whatever time,
 * each pair has at most one line. */
class BatchFile {
public:
  /** \brief Read what earlier runs have finished, and take their rank files in. Lines
   * of pairs whose files have changed are removed. \throws io::FileError if it cannot
   * be written, is in use, has something else than lines, or a pair of \p pairs with
   * other settings */
  BatchFile(const std::string& name, const std::vector<BatchPair>& pairs);

  /** \brief Positions in the manifest of the pairs that have no line yet. */
  std::vector<std::size_t>
  remaining() const;

  /** \brief Positions of the pairs whose line says that they were registered. */
  std::vector<std::size_t>
  registered() const;

  /** \brief Number of lines that were removed because files have changed. */
  int
  numChanged() const
  {
    return num_changed_;
  }

  /** \brief Whether all pairs of the manifest have a line whose status is "ok". */
  bool
  areAllOk() const;

  /** \brief Write a line, at once. \throws io::FileError */
  void
  add(const std::string& line);

  /** \brief Move the lines of the rank files here, and remove those files.
   * \throws io::FileError */
  void
  takeRankFiles();

private:
  /** Remember that the line's pair is done.
   * \return whether that was new, and true of the files as they are now */
  bool
  note(const std::string& line);

  std::string name_;
  const std::vector<BatchPair>& pairs_;
  /** Statuses of what is in the file, by the name of the pair. */
  std::map<std::string, std::string> statuses_;
  std::map<std::string, const BatchPair*> pairs_by_name_;
  int num_changed_ = 0;
  std::unique_ptr<io::LineFile> file_;
};

/** \brief The name of the file of process \p rank, 1 or more. */
std::string
rankFileName(const std::string& name, int rank);

} // namespace bayesian_icp::app
