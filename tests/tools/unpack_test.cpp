#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

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

std::string bzip2(std::string plain) {
  std::string packed(plain.size() + 1000 + plain.size() / 50, '\0');
  auto size = static_cast<unsigned>(packed.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, plain.data(), static_cast<unsigned>(plain.size()), 9, 0, 0),
            BZ_OK);
  packed.resize(size);
  return packed;
}

std::string lz4(const std::string& plain) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(plain.size(), &preferences), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), plain.data(), plain.size(), &preferences));
  return packed;
}

std::string zstd(const std::string& plain) {
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(plain.size()), '\0');
  packed.resize(ZSTD_compress2(context.get(), packed.data(), packed.size(), plain.data(), plain.size()));
  return packed;
}

/// In every way that there is.
std::vector<std::string> packings(const std::string& plain) {
  return {gzip(plain), xz(plain), bzip2(plain), lz4(plain), zstd(plain)};
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
    for (const std::string& packed : packings(plain)) {
      EXPECT_TRUE(unpack(packed) == plain) << size;
    }
  }
  for (const std::string& packed : packings(std::string(5'000'000, 'a'))) {
    EXPECT_TRUE(unpack(packed) == std::string(5'000'000, 'a'));
  }
}

TEST(Unpack, LeavesPlainBytesAlone) {
  for (const std::string plain : {"", "F", "FLASER", "FLASER 1 2 3\n"}) {
    EXPECT_EQ(unpack(plain), plain);
  }
}

TEST(Unpack, JoinsSeveralMembers) {
  const std::vector<std::string> first = packings("one ");
  const std::vector<std::string> second = packings("two");
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(unpack(first[i] + second[i]), "one two") << i;
  }
}

TEST(Unpack, RefusesACutStreamAtEveryLength) {
  const std::string plain = noise(400);
  for (const std::string& packed : packings(plain)) {
    for (std::size_t size = 6; size < packed.size(); ++size) {
      EXPECT_THROW(static_cast<void>(unpack(packed.substr(0, size))), DataError) << size;
    }
  }
}

TEST(Unpack, RefusesDamage) {
  const std::string plain = noise(400);
  for (std::string packed : packings(plain)) {
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
