/* Threads that see each other's writes late, on top of spin's sequential consistency.
 *
 * Every place in memory is a counter of the writes to it. A thread has a view: for each place, the oldest write that it
 * may still read. A relaxed load may return any write from there to the newest; a write with release carries the view of
 * its thread as a message, which a load with acquire takes over. (The view machine of Kang et al., "A Promising Semantics
 * for Relaxed-Memory Concurrency", POPL 2017, without promises.)
 *
 * Plain memory is checked for races with the same views: who reads must have seen all writes, who writes all reads.
 *
 * The model that includes this has defined PLACES.
 */
#define PRODUCER 0
#define CONSUMER 1

typedef View { byte at[PLACES] };
View sees[2];
hidden byte place_;

inline join(view, other) {
  d_step {
    place_ = 0;
    do
    :: place_ < PLACES ->
       if
       :: other.at[place_] > view.at[place_] -> view.at[place_] = other.at[place_]
       :: else
       fi;
       place_++
    :: else -> break
    od
  }
}

#define release(who, message) join(message, sees[who])
#define acquire(who, message) join(sees[who], message)

/* Any write of `place` from the oldest that `who` may still read, and later than `after`, to the newest. */
inline load(who, place, newest, result) {
  result = sees[who].at[place];
  do
  :: result < newest -> result++
  :: break
  od;
  sees[who].at[place] = result
}
