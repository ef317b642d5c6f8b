/** \file
 * \brief A report as a small document, and its two forms: Markdown and HTML.
 */
#pragma once

#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Plain text; no markup is known in it. */
struct ReportText {
  std::string text;
};

/** \brief Commands or output, as they are. */
struct ReportCode {
  std::string text;
};

/** \brief Every row has as many cells as the header. The first column is of names, the
 * others of numbers. */
struct ReportTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/** \brief A plot that is in the report's folder as FILE.svg and FILE.png. */
struct ReportFigure {
  std::string file;
  std::string caption;
};

using ReportBlock = std::variant<ReportText, ReportCode, ReportTable, ReportFigure>;

struct ReportSection {
  std::string title;
  std::vector<ReportBlock> blocks;
};

struct ReportDocument {
  std::string title;
  std::vector<ReportSection> sections;
};

/** \brief GitHub's Markdown; figures are links to the SVG files. */
void
writeMarkdown(const ReportDocument& document, std::ostream& stream);

/** \brief One section, with a heading of the second level. */
void
writeMarkdown(const ReportSection& section, std::ostream& stream);

/** \brief One HTML file that needs no other: the SVG files are in it.
 * \param[in] folder of the figures
 * \throws io::FileError if a figure cannot be read */
void
writeHtml(const ReportDocument& document,
          const std::string& folder,
          std::ostream& stream);

} // namespace bayesian_icp::evaluate
