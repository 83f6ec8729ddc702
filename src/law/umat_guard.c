/* A way back from a user material that gives up: XIT must not return to its caller, and must not
 * end the program either.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <setjmp.h>
#include <stdio.h>

/* Innermost call under guard and what its user material said, of this thread. */
static _Thread_local jmp_buf *innermost;
static _Thread_local char note[512];

/* Call work(data); 0 when it returned, 1 when it left by coulter_guard_leave. */
int coulter_guard_call(void (*work)(void *), void *data)
{
   jmp_buf here;
   jmp_buf *volatile outer = innermost;
   volatile int has_left = 0;

   note[0] = '\0';
   innermost = &here;
   if (setjmp(here) == 0)
      work(data);
   else
      has_left = 1;
   innermost = outer;
   return has_left;
}

/* Leave the innermost call; returns only when there is none. */
void coulter_guard_leave(void)
{
   if (innermost)
      longjmp(*innermost, 1);
}

/* Remember what the user material says. */
void coulter_guard_note(const char *text)
{
   snprintf(note, sizeof note, "%s", text);
}

/* What it said last since the last call under guard began; empty if nothing. */
const char *coulter_guard_text(void)
{
   return note;
}
