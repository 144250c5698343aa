/* rt/record_ring.hpp: records come out whole and in order; no word is written and read at once; what is at most half of
 * the ring fits when it is empty.
 *
 * weak: UNPUBLISHED_TAIL   kPublishTail relaxed
 * weak: UNSEEN_TAIL        kSeeTail relaxed
 * weak: UNPUBLISHED_HEAD   kPublishHead relaxed
 * weak: UNSEEN_HEAD        kSeeHead relaxed
 * weak: EARLY_TAIL         the tail is published before the record is written
 * weak: EARLY_HEAD         the head is published before the record is read
 * weak: UNCOUNTED_SKIP     the skipped end is not counted in the room that is needed
 * weak: UNMARKED_SKIP      the skipped end has no header
 */
#define WORDS 4
#define RECORDS 5
#define POSITIONS (RECORDS * 3)

#define HEAD 0
#define TAIL 1
#define WRITE_OF(word) (2 + (word))
#define READ_OF(word) (2 + WORDS + (word))
#define PLACES (2 + 2 * WORDS)
#include "views.pml"

#define SKIP 9

/* Of each word: the number of its record, and, if it is the first of one, the record's length. */
byte number_in[WORDS], length_in[WORDS];
byte writes[WORDS], reads[WORDS];

/* The n-th write to head and tail. */
byte heads = 0, tails = 0;
byte head_at[RECORDS + 1], tail_at[RECORDS + 1];
View head_message[RECORDS + 1];
View tail_message[RECORDS + 1];

inline write_word(position, number, length) {
  atomic {
    assert(sees[PRODUCER].at[READ_OF((position) % WORDS)] == reads[(position) % WORDS]);
    number_in[(position) % WORDS] = number;
    length_in[(position) % WORDS] = length;
    writes[(position) % WORDS]++;
    sees[PRODUCER].at[WRITE_OF((position) % WORDS)] = writes[(position) % WORDS]
  }
}

inline read_word(position) {
  atomic {
    assert(sees[CONSUMER].at[WRITE_OF((position) % WORDS)] == writes[(position) % WORDS]);
    reads[(position) % WORDS]++;
    sees[CONSUMER].at[READ_OF((position) % WORDS)] = reads[(position) % WORDS]
  }
}

inline publish_tail() {
  atomic {
    tails++;
    tail_at[tails] = tail + skipped + length;
    sees[PRODUCER].at[TAIL] = tails;
#ifndef UNPUBLISHED_TAIL
    release(PRODUCER, tail_message[tails])
#endif
  }
}

proctype producer() {
  byte number = 1, length, tail = 0, skipped, seen;
  do
  :: number <= RECORDS ->
     if
     :: length = 1
     :: length = 2
     fi;
     atomic {
       load(PRODUCER, HEAD, heads, seen);
#ifndef UNSEEN_HEAD
       acquire(PRODUCER, head_message[seen])
#endif
     }
     skipped = (length <= WORDS - tail % WORDS -> 0 : WORDS - tail % WORDS);
     if
#ifdef UNCOUNTED_SKIP
     :: tail - head_at[seen] + length > WORDS ->
#else
     :: tail - head_at[seen] + skipped + length > WORDS ->
#endif
        assert(head_at[seen] < tail) /* never refused when empty */
     :: else ->
#ifdef EARLY_TAIL
        publish_tail();
#endif
#ifndef UNMARKED_SKIP
        if
        :: skipped > 0 -> write_word(tail, 0, SKIP)
        :: else
        fi;
#endif
        write_word(tail + skipped, number, length);
        if
        :: length == 2 -> write_word(tail + skipped + 1, number, 0)
        :: else
        fi;
#ifndef EARLY_TAIL
        publish_tail();
#endif
        tail = tail_at[tails];
        number++
     fi
  :: else -> break
  od
}

inline publish_head() {
  atomic {
    heads++;
    head_at[heads] = head + length;
    sees[CONSUMER].at[HEAD] = heads;
#ifndef UNPUBLISHED_HEAD
    release(CONSUMER, head_message[heads])
#endif
  }
}

proctype consumer() {
  byte number = 1, length, head = 0, seen;
  do
  :: number <= RECORDS ->
     atomic {
       load(CONSUMER, TAIL, tails, seen);
#ifndef UNSEEN_TAIL
       acquire(CONSUMER, tail_message[seen])
#endif
     }
     if
     :: head == tail_at[seen]
     :: else ->
        read_word(head);
        if
        :: length_in[head % WORDS] == SKIP ->
           head = head + WORDS - head % WORDS;
           read_word(head)
        :: else
        fi;
        length = length_in[head % WORDS];
#ifdef EARLY_HEAD
        publish_head();
#endif
        assert(length == 1 || length == 2);
        assert(number_in[head % WORDS] == number);
        if
        :: length == 2 -> read_word(head + 1); assert(number_in[(head + 1) % WORDS] == number)
        :: else
        fi;
#ifndef EARLY_HEAD
        publish_head();
#endif
        head = head + length;
        number++
     fi
  :: else -> break
  od
}

init { atomic { run producer(); run consumer() } }
