/* rt/latest_value.hpp: no buffer is written and read at once, and every update shows a newer value, at the end the last.
 *
 * weak: UNPUBLISHED_VALUE  kPublish without release
 * weak: UNAWAITED_READER   kPublish without acquire
 * weak: UNSEEN_VALUE       kUpdate without acquire
 * weak: UNRELEASED_BUFFER  kUpdate without release
 * weak: PLAIN_PUBLISH      a load and a store in place of the exchange of publish
 * weak: PLAIN_UPDATE       the same in update
 * weak: UNASKED_UPDATE     update takes the middle whether it is new or not
 */
#define WRITES 5

#define WRITE_OF(buffer) (buffer)
#define READ_OF(buffer) (3 + (buffer))
#define PLACES 6
#include "views.pml"

byte value[3];
byte writes[3], reads[3];
byte middle = 2;
bool is_new = false;
View message;
bool done = false;

proctype writer() {
  byte number, back = 0, taken;
  for (number : 1 .. WRITES) {
    atomic {
      assert(sees[PRODUCER].at[READ_OF(back)] == reads[back]);
      value[back] = number;
      writes[back]++;
      sees[PRODUCER].at[WRITE_OF(back)] = writes[back]
    }
#ifdef PLAIN_PUBLISH
    taken = middle;
#endif
    atomic {
#ifndef PLAIN_PUBLISH
      taken = middle;
#endif
#ifndef UNAWAITED_READER
      acquire(PRODUCER, message);
#endif
#ifndef UNPUBLISHED_VALUE
      release(PRODUCER, message);
#endif
      middle = back;
      is_new = true;
      back = taken
    }
  }
  done = true
}

inline read_front() {
  atomic {
    assert(sees[CONSUMER].at[WRITE_OF(front)] == writes[front]);
    reads[front]++;
    sees[CONSUMER].at[READ_OF(front)] = reads[front]
  }
}

proctype reader() {
  byte front = 1, seen = 0, taken;
  bool ending = false;
  do
  :: ending = done;
     if
#ifdef UNASKED_UPDATE
     :: true ->
#else
     :: is_new ->
#endif
        read_front(); /* value() may be read until here */
#ifdef PLAIN_UPDATE
        taken = middle;
#endif
        atomic {
#ifndef PLAIN_UPDATE
          taken = middle;
#endif
#ifndef UNSEEN_VALUE
          acquire(CONSUMER, message);
#endif
#ifndef UNRELEASED_BUFFER
          release(CONSUMER, message);
#endif
          middle = front;
          is_new = false;
          front = taken
        }
        read_front();
        assert(value[front] > seen);
        seen = value[front]
     :: ending && !is_new -> break
     :: !ending /* saw a flag of before */
     fi
  od;
  assert(seen == WRITES)
}

init { atomic { run writer(); run reader() } }
