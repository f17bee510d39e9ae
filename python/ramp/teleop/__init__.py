"""Teleoperation: a person drives the arm, by keyboard, gamepad or 6-axis mouse, or by a file of timed events.

``ramp teleop`` starts this package. The operator is an agent of the track that it works on: it sees the
images, the wrench and the joints that the track gives, and acts by Cartesian velocities. Log and result are
those of any episode, and the demonstration is made of the log.

``settings`` has all numbers and keys; ``controls`` turns events into actions; ``script`` reads them from a
file, ``window`` and ``devices`` from a person; ``operator`` is the loop; ``session`` runs the episode and
writes the files. The window needs the extra ``teleop``: ``pip install 'ramp-benchmark[data,teleop]'``.
"""
