/** \file
 * \brief Self-contained HTML pages for reports: no script, nothing from elsewhere,
 * readable on a phone, in light and dark, and on paper.
 *
 * Parameters and fields called `..._html` are HTML already; all other text is plain and
 * is escaped here.
 */
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bayesian_icp::html {

/** \brief \p text fit for elements and for attributes in either quotes. What is not
 * UTF-8, and control characters other than tab and newline, which HTML does not allow,
 * become U+FFFD. */
std::string
escaped(std::string_view text);

/** \brief A table whose first column names its rows. */
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  /** Columns from this one on hold words and are left aligned; those before it, the
   * first one aside, hold numbers and are right aligned. */
  std::size_t first_column_of_words = 1000;
};

std::string
tableHtml(const Table& table);

/** \brief The first \p max_rows of a table; nothing if it has none.
 * \param[in] more follows the number of rows that are left out */
std::string
limitedTableHtml(Table table, std::size_t max_rows, const std::string& more);

/** \brief `<p>`; nothing for an empty text. */
std::string
paragraphHtml(const std::string& text);

/** \brief `<ul>`; nothing for an empty list. */
std::string
listHtml(const std::vector<std::string>& items);

/** \brief Text to be copied as it is: a command, numbers. */
std::string
codeHtml(const std::string& text);

/** \brief An `<svg>` that scales with its place, for use inside a page: without what
 * belongs to documents, with ids that no other figure has, a title and a description
 * for those who cannot see it, and the page's text colour for all that gnuplot would
 * draw in black, so that it can be read on light and on dark pages.
 * \param[in] document as gnuplot's terminal svg writes it
 * \param[in] id of the figure, unique in the page: letters, digits and '-'
 * \param[in] title,description plain text; they are escaped here */
std::string
inlineSvg(const std::string& document,
          const std::string& id,
          const std::string& title,
          const std::string& description);

/** \brief How much of the page's width a figure takes. */
enum class FigureWidth {
  /** Beside others of its kind, as many as there is room for. */
  Small,
  /** All of it; where that is too little to read it, the figure can be scrolled. */
  Scrolled
};

/** \brief A picture with its caption; \p svg_html is what inlineSvg() makes. */
std::string
figureHtml(const std::string& svg_html,
           const std::string& caption,
           FigureWidth width = FigureWidth::Small);

/** \brief Small figures beside each other: as many as there is room for, or at most
 * two. */
enum class FigureGrid { Any, Pairs };

std::string
figureGridHtml(const std::string& figures_html, FigureGrid grid = FigureGrid::Any);

/** \brief What the colours of the figures below it mean: pairs of "#RRGGBB" and words.
 */
std::string
legendHtml(const std::vector<std::pair<std::string, std::string>>& colours);

/** \brief A part of the page with a heading; \p id names it in links. */
std::string
sectionHtml(const std::string& id,
            const std::string& heading,
            const std::string& content_html);

/** \brief A part that is closed until its summary is clicked; open in print. */
std::string
detailsHtml(const std::string& summary, const std::string& content_html);

/** \brief How a reader ought to take what a box says. */
enum class Tone { Good, Caution, Bad };

/** \brief A coloured box with a heading: colour, sign and words say the same. */
std::string
boxHtml(Tone tone, const std::string& heading, const std::string& content_html);

/** \brief The whole document, in English. Browsers are told to load nothing and to run
 * nothing. */
std::string
pageHtml(const std::string& title, const std::string& body_html);

} // namespace bayesian_icp::html
