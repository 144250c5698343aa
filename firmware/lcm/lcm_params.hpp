#pragma once

#include <string>

#include "core/base/parameters.hpp"

namespace odoless {

/// What is published over LCM, where, and how often.
struct LcmParams {
  std::string url = "udpm://239.255.76.67:7667";
  int ttl = 0;
  std::string key_file{};
  std::string prefix = "ODOLESS_";
  double map_refresh_s = 5.0;
  double overview_s = 2.0;
  int send_again = 2;
  bool raw_bytes = false;
  bool scan_points = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("url", self.url,
               "Where messages go: udpm://GROUP:PORT, or another address of LCM; empty: they are not sent.");
    visit.value("ttl", self.ttl, Range{0, 255},
                "How many routers pass the messages on; 0: they stay on this host. LCM itself knows no authentication: "
                "see key_file.");
    visit.text(
        "key_file", self.key_file,
        "File with a key of 64 hexadecimal digits: scans and motions are sent with an HMAC-SHA-256, and only such "
        "are taken from others; empty: none is sent or asked for.");
    visit.text("prefix", self.prefix, "Prefix of the name of every channel.");
    visit.value("map_refresh_s", self.map_refresh_s, Range{0.5, 3600.0},
                "Period in which every tile of the map is sent again.");
    visit.value("overview_s", self.overview_s, Range{0.2, 3600.0}, "Period of the message with the whole map.");
    visit.value("send_again", self.send_again, Range{0, 9},
                "How often a scan or motion for a filter elsewhere is sent again before the next message, and as often "
                "before the one after it, so that lost datagrams cost nothing; at 40 Hz and 1081 beams 0.7 MB/s each.");
    visit.flag("raw_bytes", self.raw_bytes,
               "Whether the bytes to and from laser and tilt servo are sent; they are recorded in any case.");
    visit.flag("scan_points", self.scan_points, "Whether each scan is also sent as points in the map.");
  }
};

}  // namespace odoless
