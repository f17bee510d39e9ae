"""An agent that takes its time after it has said that it is done, and paints the terminal."""
import sys
import time

from common import hear, hello, tell

hello("slow-end")
sys.stderr.write("\x1b]0;owned\x07\x1b[2J\x9b2J\rhello\n")
sys.stderr.flush()
tell({"done": {}})
hear()
time.sleep(0.9)
