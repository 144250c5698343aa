#include <gtest/gtest.h>
#include <lzma.h>
#include <zlib.h>

#include "core/base/rng.hpp"
#include "tools/command/error.hpp"
#include "tools/log/byte_stream.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {
namespace {

std::string gzip(const std::string& plain) {
  z_stream state{};
  EXPECT_EQ(deflateInit2(&state, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(plain.size() + 1000, '\0');
  state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  state.avail_in = static_cast<uInt>(plain.size());
  state.next_out = reinterpret_cast<Bytef*>(packed.data());
  state.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&state, Z_FINISH), Z_STREAM_END);
  packed.resize(state.total_out);
  deflateEnd(&state);
  return packed;
}

std::string xz(const std::string& plain) {
  std::string packed(plain.size() + 1000, '\0');
  std::size_t size = 0;
  EXPECT_EQ(lzma_easy_buffer_encode(6, LZMA_CHECK_CRC64, nullptr, reinterpret_cast<const std::uint8_t*>(plain.data()),
                                    plain.size(), reinterpret_cast<std::uint8_t*>(packed.data()), &size, packed.size()),
            LZMA_OK);
  packed.resize(size);
  return packed;
}

/// Reads in pieces of changing size.
std::string unpack(const std::string& packed) {
  const auto stream = view_bytes(packed, "packed");
  std::string plain;
  std::string piece(1, '\0');
  while (const std::size_t got = stream->read(piece)) {
    plain.append(piece, 0, got);
    piece.resize(piece.size() % 5000 + 777);
  }
  EXPECT_EQ(stream->read(piece), 0U) << "the end stays the end";
  return plain;
}

std::string noise(std::size_t size) {
  Rng rng(3);
  std::string text(size, '\0');
  for (char& c : text) {
    c = static_cast<char>(rng.below(256));
  }
  return text;
}

TEST(Unpack, GivesBackWhatWasPacked) {
  for (const std::size_t size : {0U, 1U, 5U, 6U, 7U, 1000U, 300'000U}) {
    const std::string plain = noise(size);
    EXPECT_EQ(unpack(gzip(plain)), plain);
    EXPECT_EQ(unpack(xz(plain)), plain);
  }
  EXPECT_EQ(unpack(gzip(std::string(5'000'000, 'a'))), std::string(5'000'000, 'a'));
}

TEST(Unpack, LeavesPlainBytesAlone) {
  for (const std::string plain : {"", "F", "FLASER", "FLASER 1 2 3\n"}) {
    EXPECT_EQ(unpack(plain), plain);
  }
}

TEST(Unpack, JoinsSeveralMembers) {
  EXPECT_EQ(unpack(gzip("one ") + gzip("two")), "one two");
  EXPECT_EQ(unpack(xz("one ") + xz("two")), "one two");
}

TEST(Unpack, RefusesACutStreamAtEveryLength) {
  const std::string plain = noise(400);
  for (const std::string& packed : {gzip(plain), xz(plain)}) {
    for (std::size_t size = 6; size < packed.size(); ++size) {
      EXPECT_THROW(static_cast<void>(unpack(packed.substr(0, size))), DataError) << size;
    }
  }
}

TEST(Unpack, RefusesDamage) {
  const std::string plain = noise(400);
  for (std::string packed : {gzip(plain), xz(plain)}) {
    for (std::size_t at = packed.size() / 4; at < packed.size() * 3 / 4; ++at) {
      packed[at] = static_cast<char>(packed[at] ^ 0x10);
      EXPECT_THROW(static_cast<void>(unpack(packed)), DataError) << at;
      packed[at] = static_cast<char>(packed[at] ^ 0x10);
    }
  }
  EXPECT_THROW(static_cast<void>(unpack(gzip("a") + "rubbish")), DataError);
}

TEST(LineReader, GivesLinesWhateverTheirEnds) {
  const std::string long_line(200'000, 'x');
  const std::string text = "a\r\n\n" + long_line + "\nlast";
  LineReader lines(view_bytes(text, "text"), "text");
  std::string_view line;
  std::vector<std::string> all;
  while (lines.next(line)) {
    all.emplace_back(line);
  }
  EXPECT_TRUE(all == (std::vector<std::string>{"a", "", long_line, "last"}));
  EXPECT_EQ(lines.number(), 4);
}

std::vector<std::string> lines_of(const std::string& text) {
  LineReader lines(view_bytes(text, "text"), "text");
  std::string_view line;
  std::vector<std::string> all;
  while (lines.next(line)) {
    all.emplace_back(line);
  }
  return all;
}

TEST(LineReader, PassesOverTheMarkThatEditorsPutFirstAndRefusesUtf16) {
  const std::string mark = "\xEF\xBB\xBF";
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of(mark + "one\ntwo"), (Lines{"one", "two"}));
  EXPECT_EQ(lines_of(mark), Lines{});
  EXPECT_EQ(lines_of("a\n" + mark + "b"), (Lines{"a", mark + "b"}));
  EXPECT_EQ(lines_of(gzip(mark + "one")), Lines{"one"});
  EXPECT_EQ(lines_of("\xEF"), Lines{"\xEF"});
  for (const std::string& text : {std::string("\xFF\xFEx\0", 4), std::string("\xFE\xFF\0x", 4)}) {
    EXPECT_THROW(static_cast<void>(lines_of(text)), DataError);
  }
}

TEST(LineReader, RefusesToKeepMoreThanItMay) {
  LineReader lines(view_bytes("a\nb\n", "text"), "text", 100);
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  lines.keep(100);
  ASSERT_TRUE(lines.next(line));
  EXPECT_THROW(lines.keep(1), DataError);
}

}  // namespace
}  // namespace odoless
