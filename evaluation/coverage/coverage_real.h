/** \file
 * \brief Real scans as cases of the coverage study: pairs, and pairs of recordings.
 */
#pragma once

#include "study/coverage_case.h"
#include "study/recordings.h"
#include "study/scan_pairs.h"

#include <map>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief A case whose source is a random part of the pair's, 2000 points at most,
 * displaced by a pose drawn from the pair's prior.
 * \throws io::FileError if it has no prior, or its files cannot be read */
CoverageCase
makeRealCase(const std::string& folder, const ManifestEntry& entry, std::uint64_t seed);

/** \brief Which pairs, and from which guesses. */
struct SequenceOptions {
  /** The source is this number of scans after the target. */
  std::size_t step = 1;
  /** Largest number of pairs of a recording, evenly spread; 0: all. */
  std::size_t max_pairs = 0;
  /** Of the guess about the sensor, of each axis. */
  AxisDeviation guess_sd = {0.1, 0.03};
  /** Of the guesses, and of the motions by which the sources are turned. */
  std::uint64_t seed = 1;
  /** File of pairs with guesses and truths, as readPairPoses() takes it, in place of
   * random ones; empty: none. */
  std::string rows_file;
};

/** \brief The pairs of the recordings in a folder. */
class SequencePairs {
public:
  /** \brief Read all but the scans.
   * \throws io::FileError */
  SequencePairs(const std::string& folder, const SequenceOptions& options);

  /** \brief Names of the recordings. */
  std::vector<std::string>
  names() const;

  /** \brief A recording's quality and what tells these guesses from others. */
  std::string
  condition(const std::string& name) const;

  /** \brief Numbers of the targets' scans. */
  std::vector<std::uint64_t>
  pairs(const std::string& name) const;

  /** \brief A pair with the default prior about the guess.
   *
   * The source is turned by 0.5 rad and shifted by 0.5 m first, both in random
   * directions, so that no answer is right for being the identity; with a file of rows,
   * by what the truth there asks for. The case's seed is the program's default. May be
   * called by several threads.
   * \throws io::FileError if a scan cannot be read */
  CoverageCase
  makeCase(const std::string& name, std::uint64_t pair) const;

private:
  const Recording&
  recordingOf(const std::string& name) const;

  /** Number of pairs of scans. */
  std::size_t
  numPairs(const Recording& recording) const;

  void
  readRows();

  PairPoses
  posesOf(const Recording& recording, std::uint64_t pair) const;

  SequenceOptions options_;
  std::vector<Recording> recordings_;
  /** The pairs of each recording and their poses in the file of rows. */
  std::map<std::string, std::map<std::uint64_t, PairPoses>> rows_;
  /** Part of condition(). */
  std::string guesses_;
};

} // namespace bayesian_icp::evaluate
