/** \file
 * \brief Pictures drawn by gnuplot, as SVG in memory.
 */
#pragma once

#include "io/errors.h"

#include <string>
#include <vector>

namespace bayesian_icp::plot {

/** \brief gnuplot is not there, or does not draw. */
struct GnuplotError : io::FileError {
  explicit GnuplotError(const std::string& reason) : io::FileError("gnuplot", reason) {}
};

/** \brief A string of gnuplot's. */
std::string
quotedForGnuplot(const std::string& text);

/** \brief Lines that give data a name, $NAME.
 * \param[in] lines numbers with spaces between, ends of lines included */
std::string
dataBlock(const std::string& name, const std::string& lines);

/** \brief One picture to be drawn as SVG. */
struct Drawing {
  /** [pixels] */
  int width = 360;
  int height = 260;
  /** Commands and inline data that draw it; settings of earlier drawings are gone. */
  std::string script;
};

/** \brief The drawings as SVG documents, in their order. Backgrounds are transparent;
 * html::inlineSvg() puts them into pages.
 * \throws GnuplotError if it is not there, or does not draw them */
std::vector<std::string>
drawSvgs(const std::vector<Drawing>& drawings);

} // namespace bayesian_icp::plot
