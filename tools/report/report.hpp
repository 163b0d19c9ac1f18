#pragma once
// report.html: one self-contained page that opens offline, on a desktop, on a phone and on paper. Its first screen
// answers the question of the run (one sentence, one number, one plot, one picture); plots, tables and the resolved
// configuration follow.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "tools/report/chart.hpp"
#include "tools/time_table.hpp"

namespace heartservo::tools {

/// What a colour of a picture means.
struct PictureKey {
  enum class Mark { LINE, DASHES, AREA };
  std::string label;
  cv::Scalar bgr;  ///< 0 to 255
  Mark mark = Mark::LINE;
};

struct ReportPicture {
  std::string caption;
  cv::Mat bgr;                        ///< 8 bit, 3 channels or grey; wider than 1280 px it is reduced to that
  std::vector<PictureKey> keys = {};  ///< shown as a legend below
  std::string chapter = {};           ///< "": among the pictures of the page; else see Report
};

/// A short film inside the page, WebM.
struct ReportVideo {
  std::string caption;
  std::filesystem::path file;  ///< read when the page is made; empty for none
};

struct ReportSeries {
  std::string label;      ///< "heart z"
  std::string column;     ///< of the table
  bool is_truth = false;  ///< what the others should be: drawn broad and pale below them
};

/// Columns over the table's first: time, or frequency. Plots over time of one table zoom and point together.
struct ReportPlot {
  std::string title;
  std::string y_label;  ///< with the unit people read: "mm"
  std::vector<ReportSeries> series;
  double scale = 1;                  ///< from the table's unit to the plot's (m to mm: 1000)
  std::string note = "";             ///< one line below the title, "" for none
  const TimeTable* table = nullptr;  ///< nullptr: the report's
  double log_from = 0;               ///< above 0: a logarithmic axis, on which smaller values lie at this one
  bool about_mean = false;           ///< each series less its mean: only the motion matters
  std::string chapter = {};
};

/// Rows of text: key and value (no header), or a comparison with a header. Cells that look like numbers align right.
struct ReportTable {
  std::string title;
  std::vector<std::string> header;  ///< empty for key and value
  std::vector<std::vector<std::string>> rows;
  std::string note;
  bool wide = false;  ///< over the whole page; else only with more than five columns
  std::string chapter = {};
};

/// Tables, plots and pictures that name the same chapter stand together under that heading; the chapters come first, in
/// the order of their tables, with a list of links above them.
struct Report {
  std::string title;                    ///< "servo pig_2007"
  std::string headline;                 ///< the answer in one sentence: "The tip stands still to 0.41 mm RMS ..."
  std::string headline_number;          ///< "0.41"
  std::string headline_unit;            ///< "mm RMS residual"
  std::vector<std::string> notices;     ///< what a reader must know first: "ended by Ctrl-C after 12 s of 60 s"
  std::vector<ReportPlot> plots;        ///< the first is on the first screen: residual against motion
  std::vector<ReportChart> charts;      ///< of many runs; before everything else
  std::vector<ReportPicture> pictures;  ///< so is the first of these
  ReportVideo video;                    ///< after them
  std::vector<ReportTable> tables;
  const TimeTable* table = nullptr;  ///< must live until write_report() returns
  std::vector<ReportSeries>
      states;               ///< columns of `table`: 0 OK, 1 uncertain, 2 lost; a strip each, named by its label
  std::string config_yaml;  ///< resolved configuration; "" for none
  nlohmann::json summary;   ///< summary.json, embedded for scripts and shown; null for none
};

/// The page as text. Throws std::invalid_argument for a column that the table lacks.
std::string report_html(const Report& report);

/// Throws ConfigError when `file` cannot be written.
void write_report(const Report& report, const std::filesystem::path& file);

}  // namespace heartservo::tools
