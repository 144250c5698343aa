#include "core/scan/scan_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kEver_s = std::numeric_limits<double>::infinity();
constexpr std::int64_t kNear_ns = 4'000'000;  // two scans cannot be nearer: one of their stamps is wrong
constexpr double kPeriod_max_s = 10.0;
constexpr double kPeriod_unknown_s = 0.1;  // of a laser of which nothing is known yet
constexpr double kGap_max_s = 3600.0;      // a longer jump is taken for a clock that was set
constexpr double kLate_again = 0.5;        // share of stamps that are late after one that was off
constexpr double kEarly_again = 0.2;
constexpr double kSlip_max_s = 3.0;      // by which stamps come to be earlier again without that a clock was set
constexpr double kSlips = 0.3;           // in as many scans as habits begin with
constexpr double kLog_forget = -10.0;    // an account that is so much less likely is dropped
constexpr double kSame = 0.1;            // of the period; accounts that expect the next stamp so near are one
constexpr double kSettled = 0.02;        // of the weight; with less for the others an account is settled
constexpr double kOff_memory = 30.0;     // late stamps, of which the usual delay is learnt
constexpr double kGap_doubt = 0.25;      // of a jump; as if one such stamp of 16 were after a gap
constexpr double kHabit_scans = 1000.0;  // that habits are remembered
constexpr double kAs_told = 0.03;        // of the period; nearer to the told time the told one is given
constexpr double kStep_min = 0.1;        // of the period, from scan to scan
constexpr double kBunched = 0.1;         // of the period
constexpr double kDoubtful = 0.25;       // of the period
constexpr double kOff_sd_min = 0.03;     // of the period
constexpr double kOff_sd_begin = 0.3;    // of the period
constexpr int kBegin_scans = 8;          // before the spread of the stamps is learnt
constexpr int kWarm_up_scans = 32;

std::int64_t minus(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) {
    return a < b ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
  }
  return difference;
}

std::int64_t plus(std::int64_t a, double b_s) {
  constexpr double kLimit_s = 9.2e9;
  const std::int64_t b_ns = std::llround(std::clamp(b_s, -kLimit_s, kLimit_s) * 1e9);
  return minus(a, -b_ns);
}

double square(double x) { return x * x; }

double normal_density(double x, double sd) {
  constexpr double kPeak = 0.3989422804014327;
  return kPeak / sd * math::exp(-0.5 * square(x / sd));
}

// Of a jump by off_s: heavy-tailed, for nothing says how long a gap is.
double jump_density(double off_s, double period_s) { return period_s / square(std::abs(off_s) + period_s); }

}  // namespace

ScanTime ScanClock::next(std::int64_t stamp_ns, std::int64_t arrival_ns) {
  ScanTime time{.time_ns = stamp_ns};
  if (findings_.scans == 0) {
    origin_ns_ = stamp_ns;
    account_count_ = 1;
    rhythm_.add(0.0);
  } else {
    const bool timed = arrival_ns != kNoArrival && arrival_ns_ != kNoArrival;
    extend(stamp_ns, timed ? 1e-9 * static_cast<double>(minus(arrival_ns, arrival_ns_)) : kEver_s);
    time = tell(stamp_ns);
  }
  time.flags |= order_flags(stamp_ns);
  count(time);
  stamp_ns_ = stamp_ns;
  arrival_ns_ = arrival_ns;
  time_ns_ = time.time_ns;
  return time;
}

double ScanClock::period_s() const {
  return rhythm_.period_s() > ScanRhythm::kPeriod_min_s ? rhythm_.period_s() : kPeriod_unknown_s;
}

double ScanClock::gate_s() const { return std::max(4.0 * off_sd_s_, 0.75 * period_s()); }

double ScanClock::since_start_s(std::int64_t stamp_ns, std::int64_t ahead_ns) const {
  return 1e-9 * static_cast<double>(minus(minus(stamp_ns, ahead_ns), origin_ns_));
}

// Every account goes on, and where the stamp is far off it is also taken for the first after a jump.
void ScanClock::extend(std::int64_t stamp_ns, double arrived_after_s) {
  const double told_s = since_start_s(stamp_ns, 0);
  const bool is_second = findings_.scans == 1 && told_s > ScanRhythm::kPeriod_min_s && told_s < kPeriod_max_s;
  expected_s_ = is_second ? told_s : period_s();
  if (findings_.scans <= kBegin_scans) {
    off_sd_s_ = kOff_sd_begin * expected_s_;
  }
  is_too_near_ = minus(stamp_ns, stamp_ns_) < kNear_ns;
  const std::array<Account, kAccountsMax> before = accounts_;
  const int count = std::exchange(account_count_, 0);
  for (int i = 0; i < count; ++i) {
    const Account& account = before[static_cast<std::size_t>(i)];
    const double off_s = since_start_s(stamp_ns, account.ahead_ns) - (account.time_s + expected_s_);
    offer(gone_on(account, off_s));
    if (std::abs(off_s) > gate_s()) {
      offer(jumped(account, off_s, arrived_after_s));
      if (i == 0 && opened_ < 0) {
        opened_ = findings_.scans;
        opened_off_s_ = off_s;
      }
    }
  }
  follow(before[0]);
  may_be_gap_ = accounts_[0].is_off && !is_too_near_ && is_gap(accounts_[0].off_s, arrived_after_s);
  rhythm_.add(told_s - accounts_[0].left_out_s);
  learn();
}

// The rhythm is held; a stamp that is off is believed by as much as it is likely to be of the rhythm.
ScanClock::Account ScanClock::gone_on(const Account& account, double off_s) const {
  const double off_habit = off_s > 0.0 ? habits_.late : habits_.early;
  const double off_share = account.is_off ? (off_s > 0.0 ? kLate_again : kEarly_again) : off_habit / habits_.scans;
  const double off_density = 2.0 * off_share * normal_density(off_s, habits_.off_s);
  const double on_sd_s = std::max(1.3 * off_sd_s_, kOff_sd_min * expected_s_);
  const double on_density = is_too_near_ && !account.is_off ? 0.0 : (1.0 - off_share) * normal_density(off_s, on_sd_s);
  const double on_share = on_density > 0.0 ? on_density / (on_density + off_density) : 0.0;
  Account out = account;
  out.time_s += expected_s_ + gain(account) * on_share * std::clamp(off_s, -gate_s(), gate_s());
  out.off_s = off_s;
  out.is_off = on_share < 0.5;
  out.log_weight += math::log(std::max(on_density + off_density, std::numeric_limits<double>::min()));
  return out;
}

// Whether scans may be missing where a stamp is so much after its time, of a scan that came so long after the last one.
bool ScanClock::is_gap(double off_s, double arrived_after_s) const {
  return off_s > 0.0 && off_s < kGap_max_s && arrived_after_s > 0.5 * (expected_s_ + off_s);
}

// Scans are missing, or, where the stamps go back, jump by hours, or the scan came too soon for it, the clock was set.
ScanClock::Account ScanClock::jumped(const Account& account, double off_s, double arrived_after_s) const {
  const bool gap = is_gap(off_s, arrived_after_s);
  const bool is_slip = off_s < 0.0 && off_s > -kSlip_max_s;
  const double habit = gap ? habits_.gaps : is_slip ? kSlips : habits_.clock_sets;
  Account out = account;
  out.time_s += expected_s_ + (gap ? off_s : 0.0);
  out.ahead_ns = gap ? account.ahead_ns : plus(account.ahead_ns, off_s);
  out.left_out_s += off_s;
  out.gap_s = gap ? expected_s_ + off_s : 0.0;
  out.off_s = 0.0;
  out.is_off = false;
  out.origin = gap ? Origin::kGap : is_slip ? Origin::kSlip : Origin::kClockSet;
  out.born = findings_.scans;
  out.log_weight += math::log(habit / habits_.scans * jump_density(off_s, expected_s_));
  return out;
}

// A new account follows its stamps at first, and then more and more the rhythm.
double ScanClock::gain(const Account& account) const {
  return std::max(rhythm_.gain(), 1.0 / static_cast<double>(findings_.scans - account.born + 1));
}

// Keeps the likeliest, in their order. Accounts that expect the same stamp next are one.
void ScanClock::offer(const Account& account) {
  Account offered = account;
  for (int i = 0; i < account_count_; ++i) {
    Account& other = accounts_[static_cast<std::size_t>(i)];
    if (std::abs(other.phase_s() - offered.phase_s()) < kSame * period_s()) {
      const double high = std::max(other.log_weight, offered.log_weight);
      const double low = std::min(other.log_weight, offered.log_weight);
      offered = offered.log_weight > other.log_weight ? offered : other;
      offered.log_weight = high + math::log1p(math::exp(low - high));
      std::move(accounts_.begin() + i + 1, accounts_.begin() + account_count_, accounts_.begin() + i);
      --account_count_;
      break;
    }
  }
  int place = account_count_;
  while (place > 0 && accounts_[static_cast<std::size_t>(place - 1)].log_weight < offered.log_weight) {
    --place;
  }
  if (place == kAccountsMax) {
    return;
  }
  account_count_ = std::min(account_count_ + 1, kAccountsMax);
  std::move_backward(accounts_.begin() + place, accounts_.begin() + account_count_ - 1,
                     accounts_.begin() + account_count_);
  accounts_[static_cast<std::size_t>(place)] = offered;
}

// Drops what is far less likely, and corrects what the rhythm was told by an account that is no longer believed.
void ScanClock::follow(const Account& believed) {
  const double best = accounts_[0].log_weight;
  while (account_count_ > 1 &&
         accounts_[static_cast<std::size_t>(account_count_ - 1)].log_weight < best + kLog_forget) {
    --account_count_;
  }
  double others = 0.0;
  for (int i = 0; i < account_count_; ++i) {
    Account& account = accounts_[static_cast<std::size_t>(i)];
    account.log_weight -= best;
    others += i > 0 ? math::exp(account.log_weight) : 0.0;
  }
  const Account& now = accounts_[0];
  const std::int64_t since = findings_.scans - std::max(believed.born, now.born);
  rhythm_.move_last(static_cast<int>(std::min<std::int64_t>(since, ScanRhythm::kWindow)),
                    believed.left_out_s - now.left_out_s);
  if (opened_ >= 0 && others < kSettled * (1.0 + others)) {
    settle(now);
  }
}

// What a jump was is known: the next one will be looked at accordingly.
void ScanClock::settle(const Account& account) {
  if (account.born < opened_) {
    double& habit = opened_off_s_ > 0.0 ? habits_.late : habits_.early;
    habit += 1.0;
    habits_.off_s = std::sqrt(square(habits_.off_s) + (square(opened_off_s_) - square(habits_.off_s)) / kOff_memory);
  } else if (account.origin == Origin::kGap) {
    habits_.gaps += 1.0;
    ++findings_.gaps;
    findings_.longest_gap_s = std::max(findings_.longest_gap_s, account.gap_s);
  } else if (account.origin == Origin::kClockSet) {
    habits_.clock_sets += 1.0;
    ++findings_.clock_sets;
  }
  opened_ = -1;
}

// The spread of the stamps is their median deviation: what is off does not widen it.
void ScanClock::learn() {
  constexpr double kMedian_of_normal = 0.6745;
  constexpr double kRate = 0.05;
  const Account& account = accounts_[0];
  if (account.born < findings_.scans) {
    off_sd_s_ *= std::abs(account.off_s) > kMedian_of_normal * off_sd_s_ ? 1.0 + kRate : 1.0 - kRate;
    off_sd_s_ = std::max(off_sd_s_, kOff_sd_min * period_s());
  }
  const Habits first;
  const auto forget = [](double& habit, double begin) { habit += (begin - habit) / kHabit_scans; };
  forget(habits_.gaps, first.gaps);
  forget(habits_.late, first.late);
  forget(habits_.early, first.early);
  forget(habits_.clock_sets, first.clock_sets);
  habits_.scans += 1.0;
  forget(habits_.scans, first.scans);
}

ScanTime ScanClock::tell(std::int64_t stamp_ns) const {
  const Account& account = accounts_[0];
  const double told_s = since_start_s(stamp_ns, account.ahead_ns);
  const bool as_told = std::abs(told_s - account.time_s) <= kAs_told * period_s();
  const std::int64_t told_ns = as_told ? minus(stamp_ns, account.ahead_ns) : plus(origin_ns_, account.time_s);
  const std::int64_t least_ns = plus(time_ns_, std::max(1e-9, kStep_min * period_s()));
  ScanTime time{.time_ns = std::max(told_ns, least_ns)};
  time.sd_s = std::sqrt(variance_s2(1e-9 * static_cast<double>(minus(time.time_ns, origin_ns_))));
  time.flags = static_cast<std::uint8_t>(
      (time.time_ns != stamp_ns ? kTimeMoved : 0) |
      (opened_ >= 0 || account.born == findings_.scans ? kTimeJumped : 0) |
      (account.born == findings_.scans && account.origin == Origin::kClockSet ? kTimeClockSet : 0) |
      (time.sd_s > kDoubtful * period_s() ? kTimeDoubtful : 0));
  return time;
}

// Against what was said: of the likeliest account, of how far the others are from it, and of what nothing is known yet.
double ScanClock::variance_s2(double said_s) const {
  double sum = 0.0;
  double weights = 0.0;
  for (int i = 0; i < account_count_; ++i) {
    const Account& account = accounts_[static_cast<std::size_t>(i)];
    const double weight = math::exp(account.log_weight);
    sum += weight * square(account.time_s - said_s);
    weights += weight;
  }
  const double begin_s =
      findings_.scans < kWarm_up_scans ? kOff_sd_begin * period_s() / static_cast<double>(findings_.scans) : 0.0;
  const double unknown_s = rhythm_.period_s() > ScanRhythm::kPeriod_min_s ? 0.0 : period_s();
  return sum / weights + waver_s2() + square(jump_doubt_s(said_s)) + square(begin_s) + square(unknown_s);
}

// Of the time from scan to scan, for stamps that waver about the rhythm: what the filter lets through of them, and what
// it holds back of scans that come unevenly. Wider by a half, as what waves stays off for some scans.
double ScanClock::waver_s2() const {
  const double g = gain(accounts_[0]);
  const double steady = 1.0 - rhythm_.gain();
  return square(1.5 * g * off_sd_s_) * steady * (1.0 / (2.0 - g) + steady);
}

// A stamp that is taken to be late may be the first after a gap, however seldom there are any; and where the likeliest
// account has just changed, the time since the scan before is the old one's error.
double ScanClock::jump_doubt_s(double said_s) const {
  const Account& likeliest = accounts_[0];
  if (likeliest.born == findings_.scans) {
    return likeliest.origin == Origin::kClockSet ? 2.0 * period_s() : 0.0;
  }
  const double since_s = 1e-9 * static_cast<double>(minus(plus(origin_ns_, said_s), time_ns_));
  const double odd_s = std::abs(since_s - expected_s_) > 0.5 * period_s() ? since_s - expected_s_ : 0.0;
  return std::max(std::abs(odd_s), may_be_gap_ ? kGap_doubt * likeliest.off_s : 0.0);
}

// How the stamp is told against the one before.
std::uint8_t ScanClock::order_flags(std::int64_t stamp_ns) const {
  if (findings_.scans == 0) {
    return 0;
  }
  if (stamp_ns < stamp_ns_) {
    return kTimeOutOfOrder;
  }
  return 1e-9 * static_cast<double>(minus(stamp_ns, stamp_ns_)) < kBunched * period_s() ? kTimeBunched : 0;
}

void ScanClock::count(const ScanTime& time) {
  ++findings_.scans;
  findings_.moved += (time.flags & kTimeMoved) != 0 ? 1 : 0;
  findings_.doubtful += (time.flags & kTimeDoubtful) != 0 ? 1 : 0;
  findings_.out_of_order += (time.flags & kTimeOutOfOrder) != 0 ? 1 : 0;
  findings_.bunched += (time.flags & kTimeBunched) != 0 ? 1 : 0;
  findings_.period_s = rhythm_.period_s() > ScanRhythm::kPeriod_min_s ? rhythm_.period_s() : 0.0;
  findings_.waver_s = off_sd_s_;
}

}  // namespace odoless
