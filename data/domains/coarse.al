% The coarse domain: a hand, three areas in a line, beams and pegs.
%
% The possible actions and their effects. order.lp chooses the order of the beams, and this file judges it; fine.al
% defines how a hand executes each action. docs/src/reference/action-language.md explains the language.

% ---- Objects -----------------------------------------------------------------------------------------------------

sort beam.                               % the beams of the goal
sort connection.                         % two joints, to be pinned by one peg
sort way.                                % a direction in which a beam can enter; its name is for people only
sort area = { input, intermediate, assembly }.
% Pegs are interchangeable: the rules name a peg by its connection, whichever peg of the kit it is.
sort item = beam(beam) + peg(connection).

% ---- Facts of the goal and its geometry --------------------------------------------------------------------------

static base(beam).                       % the clamped beam
static joins(connection, beam, beam).    % the two beams of a connection, either way around
static enters(beam, beam).               % a male of the first goes into a female of the second
static passes(beam, beam).               % the first goes through the second, and out on the other side
static tight(connection).                % its female lets the male turn by no more than its play, 1.3 degrees
static low(beam).                        % lies lower on the table than in the assembly: all its joints are males
static entry(beam, way).                 % a straight insertion path to the beam's place
static blocked(beam, way, beam).         % the last one, at its place, is in this way
static shuttle(beam, beam).              % the first, pushed back through an open joint, lets the second be put on
static can_shuttle(beam).
static awkward(beam).                    % no link can be held both where the beam starts and at its place
static waits(beam, way, beam).           % the last one, where it starts, is in this way
static bars(beam, beam).                 % the first, at its place, leaves the hand no grasp of the second at its own
static hides(beam, connection).          % the first, at its place, is in the way of the hand with the peg
static before(beam, beam).               % the order of the beams that is being tried
static beside(area, area).

beside(input, intermediate).
beside(intermediate, assembly).
beside(A, B) if beside(B, A).
can_shuttle(B) if shuttle(B, _).

% ---- Fluents -----------------------------------------------------------------------------------------------------

inertial fluent at(area).                % where the hand is
inertial fluent in_hand(item).
inertial fluent on_sheet(item).          % where it starts: a beam on the sheet, a peg in its holder
inertial fluent in_assembly(beam).
inertial fluent aligned(beam).           % in the assembly, and exactly at its place
inertial fluent deep(beam).              % in the assembly, pushed back through an open joint to let another on
inertial fluent pinned(connection).
inertial fluent slipped(beam).           % held, but not as it should be
inertial fluent stuck(beam).             % jammed on its way in
inertial fluent regrasped(beam).         % held by the link that it will be let go by

defined fluent full.                     % the hand holds something
defined fluent closed(connection).       % the joints of a connection are in each other
defined fluent open(connection).         % and lack their peg
defined fluent rests(beam).              % there is something to put the beam on
defined fluent shut(beam, way).
defined fluent can_enter(beam).
defined fluent level(beam).              % a low beam that two females carry at its height
defined fluent droops(beam).             % a low beam that they do not: 3 mm at its free end
defined fluent pegged(beam).
defined fluent guided(beam).             % a peg holds it in a joint that does not let it turn
defined fluent steady(beam).             % does not swing
defined fluent held(beam, connection).   % by a beam that is clamped, or that meets a third one
defined fluent awaits(beam).             % another beam is still to be put on it or into it
defined fluent other_open(beam, connection).
defined fluent crooked(connection).      % one of its beams is off its place

-at(B) if at(A), A != B.
-on_sheet(I) if in_hand(I).
-on_sheet(beam(B)) if in_assembly(B).
-in_hand(I) if on_sheet(I).
-in_hand(beam(B)) if in_assembly(B).
-on_sheet(peg(C)) if pinned(C).
-in_hand(peg(C)) if pinned(C).
-aligned(B) if deep(B).
-deep(B) if aligned(B).
-slipped(B) if in_assembly(B).
-slipped(B) if on_sheet(beam(B)).
-stuck(B) if in_assembly(B).
-stuck(B) if on_sheet(beam(B)).
-regrasped(B) if on_sheet(beam(B)).

full if in_hand(_).
closed(C) if joins(C, A, B), in_assembly(A), in_assembly(B), -deep(A), -deep(B).
open(C) if closed(C), -pinned(C).
crooked(C) if joins(C, B, _), -aligned(B).

rests(B) if joins(_, B, A), in_assembly(A).
shut(B, W) if blocked(B, W, A), in_assembly(A).
shut(B, W) if waits(B, W, A), on_sheet(beam(A)).
can_enter(B) if entry(B, W), -shut(B, W).

level(A) if enters(A, F), in_assembly(F), enters(A, G), in_assembly(G), F != G.
droops(A) if low(A), in_assembly(A), -level(A).

pegged(B) if joins(C, B, _), pinned(C).
guided(B) if base(B).
guided(B) if joins(C, B, _), tight(C), pinned(C).
held(B, C) if closed(C), joins(C, B, A), base(A).
held(B, C) if closed(C), joins(C, B, A), closed(D), joins(D, A, E), E != B.
steady(B) if base(B).
steady(B) if held(B, C), held(B, D), C != D.
awaits(B) if in_assembly(B), joins(_, B, A), -in_assembly(A).
other_open(B, C) if joins(C, B, _), joins(D, B, _), open(D), C != D.

% ---- Actions of the hand -----------------------------------------------------------------------------------------

% Move to a neighbouring area, with the held item.
action move(area).
move(A) causes at(A).
impossible move(A) if at(B), -beside(A, B).

% Pick an item up from the sheet, or put the held item back there.
action pick_up(item).
pick_up(I) causes in_hand(I).
impossible pick_up(_) if full.
impossible pick_up(_) if -at(input).
impossible pick_up(I) if -on_sheet(I).
% The beams that a beam will meet are aligned before it is fetched: a full hand cannot push.
impossible pick_up(beam(B)) if joins(_, B, A), in_assembly(A), -aligned(A), -deep(A).

action put_down(item).
put_down(I) causes on_sheet(I).
impossible put_down(I) if -in_hand(I).
impossible put_down(_) if -at(input).

% Set a beam down between sheet and assembly and grasp it at another link, if no link suits both start and goal pose.
action regrasp(beam).
regrasp(B) causes regrasped(B).
impossible regrasp(B) if -in_hand(beam(B)).
impossible regrasp(B) if -at(intermediate).
impossible regrasp(B) if regrasped(B).
impossible regrasp(B) if -awkward(B).

% Insert the held beam: squarely, obliquely, through another one, or as a cap over placed males.
action assemble(beam).
assemble(B) causes in_assembly(B), aligned(B) if -stuck(B).
assemble(B) causes -stuck(B).
% A beam that it meets is misaligned by the contact, unless a peg holds it.
assemble(A) causes -aligned(B) if -stuck(A), joins(_, A, B), in_assembly(B), -base(B), -pegged(B).
% A beam that it passes through is dragged and rotated, unless a peg holds it in a joint that prevents rotation.
assemble(A) causes -aligned(B) if -stuck(A), passes(A, B), in_assembly(B), -guided(B).
impossible assemble(B) if -in_hand(beam(B)).
impossible assemble(_) if -at(assembly).
impossible assemble(B) if slipped(B).
impossible assemble(B) if awkward(B), -regrasped(B).
impossible assemble(B) if before(A, B), -in_assembly(A).
% It needs support, and an insertion path.
impossible assemble(B) if -rests(B).
impossible assemble(B) if -can_enter(B).
impossible assemble(B) if bars(A, B), in_assembly(A).
% The beams that it meets are aligned, or pushed back.
impossible assemble(B) if joins(_, B, A), in_assembly(A), -aligned(A), -deep(A).
% A droops by 3 mm at the end that enters B; if A is pushed back, it is not in the way.
impossible assemble(B) if enters(A, B), droops(A), -deep(A).
impossible assemble(B) if enters(A, B), deep(A), -shuttle(A, B).
% No connection waits for its peg: an unpinned connection would be pushed apart.
impossible assemble(_) if open(_).

% Lay the held beam down at its goal pose, without support by other beams.
action lay_down(beam).
lay_down(B) causes in_assembly(B), aligned(B).
impossible lay_down(B) if -in_hand(beam(B)).
impossible lay_down(_) if -at(assembly).
impossible lay_down(B) if slipped(B).
impossible lay_down(B) if awkward(B), -regrasped(B).
impossible lay_down(B) if before(A, B), -in_assembly(A).
impossible lay_down(B) if rests(B).
% A beam without feet or females at its height cannot receive another one.
impossible lay_down(B) if low(B).
impossible lay_down(B) if shut(B, "down").
impossible lay_down(B) if bars(A, B), in_assembly(A).

% Shuttle, first half: insert the held beam beyond its goal pose, through a joint that is open at the back.
action assemble_deep(beam).
assemble_deep(B) causes in_assembly(B), deep(B).
assemble_deep(A) causes -aligned(B) if joins(_, A, B), in_assembly(B), -base(B), -pegged(B).
impossible assemble_deep(B) if -in_hand(beam(B)).
impossible assemble_deep(_) if -at(assembly).
impossible assemble_deep(B) if slipped(B).
impossible assemble_deep(B) if awkward(B), -regrasped(B).
impossible assemble_deep(B) if before(A, B), -in_assembly(A).
impossible assemble_deep(B) if -rests(B).
impossible assemble_deep(B) if -can_enter(B).
impossible assemble_deep(B) if bars(A, B), in_assembly(A).
impossible assemble_deep(B) if joins(_, B, A), in_assembly(A), -aligned(A).
impossible assemble_deep(B) if -can_shuttle(B).
impossible assemble_deep(B) if shuttle(B, A), in_assembly(A).
impossible assemble_deep(_) if open(_).

% Shuttle, second half: slide the beam forward to its goal pose, into the beams placed meanwhile.
action slide(beam).
slide(B) causes aligned(B).
% As by a beam that is inserted, one that it enters is misaligned, unless a peg holds it.
slide(A) causes -aligned(B) if enters(A, B), in_assembly(B), -base(B), -pegged(B).
impossible slide(B) if -deep(B).
impossible slide(_) if -at(assembly).
impossible slide(_) if full.
impossible slide(B) if joins(_, B, A), -in_assembly(A).
impossible slide(B) if joins(_, B, A), in_assembly(A), -aligned(A).
impossible slide(_) if open(_).

% Press the held peg in until it is seated.
action fasten(connection).
fasten(C) causes pinned(C).
% A beam pinned to all placed partners can still rotate while a partner is missing, unless something steadies it.
fasten(C) causes -aligned(B) if joins(C, B, _), awaits(B), -steady(B), -other_open(B, C).
% A male that no joint guides rotates about its first peg, and its other end with it.
fasten(C) causes -aligned(B) if joins(C, B, _), other_open(B, C), low(B), -tight(C), -guided(B).
impossible fasten(C) if -in_hand(peg(C)).
impossible fasten(_) if -at(assembly).
impossible fasten(C) if -open(C).
impossible fasten(C) if crooked(C).
impossible fasten(C) if hides(B, C), in_assembly(B).

% Align a beam exactly: a free end before a cap, or a supporting beam after another one was slid through it.
action push(beam).
push(B) causes aligned(B).
impossible push(B) if -in_assembly(B).
impossible push(B) if deep(B).
impossible push(B) if base(B).
impossible push(_) if -at(assembly).
impossible push(_) if full.
% A beam inserted too deep would be dragged along; one that was pushed back to let it on does not reach it.
impossible push(B) if joins(_, B, A), in_assembly(A), deep(A), -shuttle(A, B).
% A beam that no peg holds drags along the beam in it. Where that one can be pinned to a third, its peg comes first.
impossible push(B) if -pegged(B), enters(A, B), -pegged(A), joins(C, A, D), D != B, closed(C), -crooked(C).

% ---- Exogenous actions -------------------------------------------------------------------------------------------

% A peg is dropped; the rules replace it by another one of the kit.
exogenous action drop_peg(connection).
drop_peg(C) causes on_sheet(peg(C)).
impossible drop_peg(C) if -in_hand(peg(C)).

% A beam rotates or slides in the grasp.
exogenous action slip(beam).
slip(B) causes slipped(B).
impossible slip(B) if -in_hand(beam(B)).

% A beam jams during its insertion, and stays in the hand.
exogenous action jam(beam).
jam(B) causes stuck(B).
impossible jam(B) if -in_hand(beam(B)).
impossible jam(_) if -at(assembly).

% The arm, or a person, bumps a placed beam.
exogenous action bump(beam).
bump(B) causes -aligned(B).
impossible bump(B) if -in_assembly(B).
impossible bump(B) if base(B).
impossible bump(B) if -aligned(B).

% ---- Initial state and goal --------------------------------------------------------------------------------------

initially at(input).
initially on_sheet(beam(B)) if -base(B).
initially on_sheet(peg(C)).
initially in_assembly(B) if base(B).
initially aligned(B) if base(B).

goal in_assembly(B).
goal pinned(C).
goal aligned(B).
% The hand is empty, and away from the assembly.
goal -full.
goal -at(assembly).
