#include "tools/experiment/html_report.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>odoless: the dissertation's experiments</title>
<style>
body { font: 16px/1.5 sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: 0.3rem 0.6rem; border-bottom: 1px solid #ddd; }
img { max-width: 100%; }
figure { margin: 1.5rem 0; }
.yes { color: #1a8550; font-weight: bold; }
.no { color: #dc3220; font-weight: bold; }
</style>
</head>
<body>
<h1>The dissertation's experiments</h1>
)";

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(const std::string& bytes) {
  constexpr std::size_t kPerGroup = 3;
  constexpr std::size_t kLettersPerGroup = 4;
  std::string text((bytes.size() + kPerGroup - 1) / kPerGroup * kLettersPerGroup + 1, '\0');
  // Both types are bytes; OpenSSL counts in int, and no figure is near that.
  const int size =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

std::string claim_rows(const Record& record) {
  const std::string name = escaped(record.experiment->name);
  if (!record.missing.empty()) {
    return fmt::format(
        "<tr><td>{}</td><td>{}</td><td colspan=\"3\">not run: {} is not among the recorded logs</td></tr>\n", name,
        escaped(record.experiment->figures), escaped(record.missing));
  }
  std::string rows;
  for (const Claim& claim : record.claims) {
    rows += fmt::format(
        "<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td>{}</td><td>{}</td><td class=\"{}\">{}</td></tr>\n", name,
        name, escaped(claim.figure), escaped(claim.stated), escaped(claim.measured), claim.agrees ? "yes" : "no",
        claim.agrees ? "agrees" : "disagrees");
  }
  return rows;
}

std::string section(const Record& record, const std::filesystem::path& out) {
  std::string text = fmt::format("<h2 id=\"{}\">{} ({})</h2>\n", escaped(record.experiment->name),
                                 escaped(record.experiment->title), escaped(record.experiment->figures));
  for (const Record::Picture& picture : record.pictures) {
    const std::string svg = read_whole_file(out / record.experiment->name / (picture.name + ".svg"));
    text += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/svg+xml;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
        escaped(picture.caption), base64(svg));
  }
  return text;
}

}  // namespace

std::string html_report(std::span<const Record> records, const std::filesystem::path& out) {
  std::string text = kHead;
  text += "<table>\n<tr><th>experiment</th><th>figure</th><th>stated</th><th>measured</th><th></th></tr>\n";
  for (const Record& record : records) {
    text += claim_rows(record);
  }
  text += "</table>\n";
  for (const Record& record : records) {
    if (record.missing.empty()) {
      text += section(record, out);
    }
  }
  return text + "</body>\n</html>\n";
}

}  // namespace odoless
