/* rt/evicting_queue.hpp: each token comes out once, in order, as it went in, and what it stands for was written before.
 *
 * weak: UNPUBLISHED_TAIL   kPublishTail relaxed
 * weak: UNSEEN_TAIL        kSeeTail relaxed
 * weak: UNPUBLISHED_HEAD   kEvict relaxed
 * weak: UNSEEN_HEAD        kSeeHead relaxed
 * weak: EARLY_TAKE         kTake relaxed: the slot is read after the swap of the head
 * weak: PLAIN_EVICTION     the producer moves the head by a store, without comparing
 * weak: PLAIN_TAKE         the consumer does
 * weak: EARLY_STORE        the producer writes the slot before it evicts
 */
#define CAPACITY 2
#define PUSHES 5

#define HEAD 0
#define TAIL 1
#define PAYLOAD 2
#define SLOT(index) (3 + (index) % CAPACITY)
#define PLACES (3 + CAPACITY)
#include "views.pml"

/* The token of index i is i + 1; the n-th write to slot s is the token of index s + (n - 1) * CAPACITY. */
#define token_of(index, write) (write == 0 -> 0 : (index) % CAPACITY + 1 + ((write) - 1) * CAPACITY)

byte head = 0, tail = 0;
byte slot_writes[CAPACITY];
View head_message[PUSHES + 1];
View tail_message[PUSHES + 1];
bool came_out[PUSHES + 1];
bool done = false;

inline come_out(token, index) {
  assert(token == index + 1);
  assert(!came_out[token]);
  came_out[token] = true
}

/* A read-modify-write passes on what the one before it had released. */
inline advance_head(who) {
  head++;
  sees[who].at[HEAD] = head;
  join(head_message[head], head_message[head - 1])
}

inline store_slot() {
  slot_writes[pushed % CAPACITY]++;
  sees[PRODUCER].at[SLOT(pushed)] = slot_writes[pushed % CAPACITY]
}

/* A swap that fails has read some head other than the expected one. */
inline see_other_head(who, expected) {
  sees[who].at[HEAD] = expected + 1;
  load(who, HEAD, head, expected)
}

proctype producer() {
  byte pushed = 0, h, write;
  do
  :: pushed < PUSHES ->
     sees[PRODUCER].at[PAYLOAD] = pushed + 1;
     atomic { load(PRODUCER, HEAD, head, h); acquire(PRODUCER, head_message[h]) }
#ifdef EARLY_STORE
     store_slot();
#endif
     if
     :: pushed - h == CAPACITY ->
        atomic { load(PRODUCER, SLOT(h), slot_writes[h % CAPACITY], write) }
        atomic {
          if
#ifdef PLAIN_EVICTION
          :: true ->
             head = h;
#else
          :: head == h ->
#endif
             advance_head(PRODUCER);
#ifndef UNPUBLISHED_HEAD
             release(PRODUCER, head_message[head]);
#endif
             come_out(token_of(h, write), h)
          :: else ->
             see_other_head(PRODUCER, h);
             acquire(PRODUCER, head_message[h])
          fi
        }
     :: else
     fi;
     assert(pushed - head < CAPACITY); /* one try made room */
#ifndef EARLY_STORE
     atomic { store_slot() }
#endif
     atomic {
       tail++;
       sees[PRODUCER].at[TAIL] = tail;
#ifndef UNPUBLISHED_TAIL
       release(PRODUCER, tail_message[tail]);
#endif
       pushed++
     }
  :: else -> break
  od;
  done = true
}

inline load_head() {
  load(CONSUMER, HEAD, head, h);
#ifndef UNSEEN_HEAD
  acquire(CONSUMER, head_message[h])
#endif
}

inline load_tail() {
  load(CONSUMER, TAIL, tail, t);
#ifndef UNSEEN_TAIL
  acquire(CONSUMER, tail_message[t])
#endif
}

inline read_slot() {
  load(CONSUMER, SLOT(h), slot_writes[h % CAPACITY], write)
}

proctype consumer() {
  byte h, t, write;
  do
  :: atomic { load_head() }
again:
     atomic { load_tail() }
     if
     :: h == t ->
        if
        :: done && t == tail -> break
        :: !done || t != tail
        fi
     :: else ->
#ifndef EARLY_TAKE
        atomic { read_slot() }
#endif
        atomic {
          if
#ifdef PLAIN_TAKE
          :: true ->
             head = h;
#else
          :: head == h ->
#endif
             advance_head(CONSUMER);
             release(CONSUMER, head_message[head])
          :: else ->
             see_other_head(CONSUMER, h);
#ifndef UNSEEN_HEAD
             acquire(CONSUMER, head_message[h]);
#endif
             goto again
          fi
        }
#ifdef EARLY_TAKE
        atomic { read_slot() }
#endif
        atomic {
          come_out(token_of(h, write), h);
          assert(sees[CONSUMER].at[PAYLOAD] > h)
        }
     fi
  od;
  /* All came out, here or by eviction. */
  for (t : 1 .. PUSHES) {
    assert(came_out[t])
  }
}

init { atomic { run producer(); run consumer() } }
