% The fine domain: refines one coarse action.
%
% The places of the hand, the link at which it grasps a beam, the joint that enters. The sorts and statics of
% coarse.al are visible here; its fluents are those below with the same name, and those defined by `bridge`. The
% planner refines one coarse action at a time, on the relevant part of the goal (zooming).

% ---- Parts and places --------------------------------------------------------------------------------------------

sort link.
sort joint.
sort part = link + joint.
sort end = { start, place }.             % where a beam starts, and its place in the assembly
sort spot = beam(beam) + hole(connection).
sort place_of_hand = above(area) + input(item) + approach(spot) + target(spot).
sort grasp = link(link) + { head }.      % a beam by a link, a peg by its head

static component(part, beam).            % the links and joints of a beam
static mates(connection, joint, joint).  % the male of a connection and its female
static through_joint(joint).             % a male in the middle of a beam
static slanted(beam).                    % enters at an angle
static tip(joint).                       % the first or the last joint of its beam
static later(joint, joint).              % on the same beam, the first is further from j1 than the second
static apart(joint, joint, number).      % on the same beam, mm
static distance(link, joint, number).    % from where the fingers close on a link to a joint of the same beam, mm
static leverage(link, number).           % from where the fingers close on a link to the middle of its beam, mm
static graspable(link, end).             % the hand reaches it there, and has room
static next(place_of_hand, place_of_hand).
static within(place_of_hand, area).

next(above(A), above(B)) if beside(A, B).
next(above(input), input(I)).
next(above(assembly), approach(X)).
next(above(assembly), target(X)).
next(P, Q) if next(Q, P).

within(above(A), A).
within(input(I), input).
within(approach(X), assembly).
within(target(X), assembly).

% ---- Fluents -----------------------------------------------------------------------------------------------------

inertial fluent hand_at(place_of_hand).
inertial fluent in_hand(item).
inertial fluent on_sheet(item).
inertial fluent in_assembly(beam).
inertial fluent aligned(beam).
inertial fluent deep(beam).
inertial fluent pinned(connection).
inertial fluent regrasped(beam).
inertial fluent held_by(grasp).

bridge at(A) if hand_at(P), within(P, A).

-hand_at(Q) if hand_at(P), P != Q.
-on_sheet(I) if in_hand(I).
-in_hand(I) if on_sheet(I).
-in_hand(beam(B)) if in_assembly(B).
-in_hand(peg(C)) if pinned(C).
-deep(B) if aligned(B).
-held_by(G) if held_by(H), G != H.

defined fluent full.
full if in_hand(_).

% ---- Types of insertion ------------------------------------------------------------------------------------------

defined fluent male(beam, joint, beam).      % joint of the first goes into the second, which stands
defined fluent female(beam, joint, beam).    % joint of the first goes around a male of the second, which stands
defined fluent meets(joint).
defined fluent enters_by(beam, joint).       % it can be inserted by this joint
defined fluent has_end(beam).
defined fluent through(beam).
male(B, J, A) if component(J, B), mates(_, J, K), component(K, A), in_assembly(A).
female(B, J, A) if component(J, B), mates(_, K, J), component(K, A), in_assembly(A), -deep(A).
meets(J) if male(_, J, _).
meets(J) if female(_, J, _).
defined fluent caps(beam).
caps(B) if female(B, _, _).
has_end(B) if male(B, J, _), -through_joint(J).
through(B) if has_end(B), male(B, J, _), through_joint(J).
% Squarely by an end joint rather than by a middle one.
enters_by(B, J) if male(B, J, _), -through_joint(J).
enters_by(B, J) if male(B, J, _), -has_end(B).

% ---- Link for carrying -------------------------------------------------------------------------------------------

defined fluent barred(link).
defined fluent can_carry(beam, link).
defined fluent closer(link, number).
defined fluent clearance(link, number).
defined fluent worse(link).
% The part of a beam ahead of the middle joint that passes through a sleeve enters the sleeve: no room for fingers.
barred(L) if component(L, B), male(B, M, _), through_joint(M), male(B, E, _), -through_joint(E), later(M, E),
    distance(L, E, N), apart(E, M, D), N < D.
barred(L) if component(L, B), male(B, M, _), through_joint(M), male(B, E, _), -through_joint(E), later(E, M),
    distance(L, E, N), apart(E, M, D), N < D.
can_carry(B, L) if component(L, B), graspable(L, start), graspable(L, place), -barred(L), -awkward(B).
can_carry(B, L) if component(L, B), graspable(L, start), awkward(B), -regrasped(B).
can_carry(B, L) if component(L, B), graspable(L, place), awkward(B), -barred(L), regrasped(B).
% Near its centre of mass, to minimise the moment in the grasp; then far from the joints that meet; then the last link.
closer(L, N) if distance(L, J, N), meets(J), distance(L, K, M), meets(K), M < N.
clearance(L, N) if distance(L, J, N), meets(J), -closer(L, N).
worse(L) if can_carry(B, L), can_carry(B, M), leverage(L, D), leverage(M, E), E < D.
worse(L) if can_carry(B, L), can_carry(B, M), leverage(L, D), leverage(M, D), clearance(L, X), clearance(M, Y), X < Y.
worse(L) if can_carry(B, L), can_carry(B, M), leverage(L, D), leverage(M, D), clearance(L, X), clearance(M, X), L < M.
worse(L) if can_carry(B, L), can_carry(B, M), leverage(L, D), leverage(M, D), L < M, -has_clearance(B).
defined fluent has_clearance(beam).
has_clearance(B) if component(L, B), clearance(L, _).

% ---- Link for pushing --------------------------------------------------------------------------------------------

defined fluent nearer(joint, number).
defined fluent freedom(joint, number).
defined fluent less_free(joint).
defined fluent free_end(beam, joint).
defined fluent too_far(link).
defined fluent push_by(beam, link).
% The free end is the one further from the joints that meet; if equal, the last one.
nearer(T, N) if tip(T), apart(T, K, N), meets(K), apart(T, I, M), meets(I), M < N.
freedom(T, N) if tip(T), apart(T, K, N), meets(K), -nearer(T, N).
less_free(T) if freedom(T, N), freedom(S, M), component(T, B), component(S, B), N < M.
less_free(T) if freedom(T, N), freedom(S, N), later(S, T).
free_end(B, T) if component(T, B), freedom(T, _), -less_free(T).
too_far(L) if free_end(B, T), distance(L, T, N), component(M, B), graspable(M, place), distance(M, T, D), D < N.
push_by(B, L) if component(L, B), graspable(L, place), free_end(B, _), -too_far(L).

% ---- Actions of the hand -----------------------------------------------------------------------------------------

% Along the graph of places; to a place in the assembly only with an empty hand: held items get there by an insertion.
action move(place_of_hand).
move(P) causes hand_at(P).
impossible move(P) if hand_at(Q), -next(Q, P).
impossible move(target(_)) if full.

action pick_up(item, grasp).
pick_up(I, G) causes in_hand(I), held_by(G).
impossible pick_up(_, _) if full.
impossible pick_up(I, _) if -hand_at(input(I)).
impossible pick_up(I, _) if -on_sheet(I).
impossible pick_up(peg(_), link(_)).
impossible pick_up(beam(_), head).
impossible pick_up(beam(B), link(L)) if -can_carry(B, L).
impossible pick_up(beam(_), link(L)) if worse(L).

action put_down(item).
put_down(I) causes on_sheet(I).
impossible put_down(I) if -in_hand(I).
impossible put_down(I) if -hand_at(input(I)).

% Change the grasp to another link of the beam.
action regrasp(beam, link).
regrasp(B, L) causes regrasped(B), held_by(link(L)).
impossible regrasp(B, _) if -in_hand(beam(B)).
impossible regrasp(_, _) if -hand_at(above(intermediate)).
impossible regrasp(B, L) if -component(L, B).
impossible regrasp(B, L) if -graspable(L, place).
impossible regrasp(_, L) if held_by(link(L)).

% All insertions begin at the approach and end with an empty hand at the goal pose of the beam.
action assemble_square(beam, joint).
assemble_square(B, J) causes in_assembly(B), aligned(B), hand_at(target(beam(B))).
impossible assemble_square(B, _) if -in_hand(beam(B)).
impossible assemble_square(B, _) if -hand_at(approach(beam(B))).
impossible assemble_square(B, J) if -enters_by(B, J).
impossible assemble_square(B, _) if through(B).
impossible assemble_square(B, _) if slanted(B).

% Obliquely, along the beam's own axis.
action assemble_angled(beam, joint).
assemble_angled(B, J) causes in_assembly(B), aligned(B), hand_at(target(beam(B))).
impossible assemble_angled(B, _) if -in_hand(beam(B)).
impossible assemble_angled(B, _) if -hand_at(approach(beam(B))).
impossible assemble_angled(B, J) if -enters_by(B, J).
impossible assemble_angled(B, _) if through(B).
impossible assemble_angled(B, _) if -slanted(B).

% Through the sleeves of another beam, and with its end into the next one.
action assemble_through(beam, joint).
assemble_through(B, J) causes in_assembly(B), aligned(B), hand_at(target(beam(B))).
impossible assemble_through(B, _) if -in_hand(beam(B)).
impossible assemble_through(B, _) if -hand_at(approach(beam(B))).
impossible assemble_through(B, J) if -enters_by(B, J).
impossible assemble_through(B, _) if -through(B).

% Over males of the assembly.
action assemble_cap(beam).
assemble_cap(B) causes in_assembly(B), aligned(B), hand_at(target(beam(B))).
impossible assemble_cap(B) if -in_hand(beam(B)).
impossible assemble_cap(B) if -hand_at(approach(beam(B))).
impossible assemble_cap(B) if male(B, _, _).
impossible assemble_cap(B) if -caps(B).

action lay_down(beam).
lay_down(B) causes in_assembly(B), aligned(B), hand_at(target(beam(B))).
impossible lay_down(B) if -in_hand(beam(B)).
impossible lay_down(B) if -hand_at(approach(beam(B))).
impossible lay_down(B) if component(J, B), meets(J).

action assemble_deep(beam, joint).
assemble_deep(B, J) causes in_assembly(B), deep(B), hand_at(target(beam(B))).
impossible assemble_deep(B, _) if -in_hand(beam(B)).
impossible assemble_deep(B, _) if -hand_at(approach(beam(B))).
impossible assemble_deep(B, J) if -enters_by(B, J).

% The next two begin and end with an empty hand at the beam.
action slide(beam, link).
slide(B, L) causes aligned(B).
impossible slide(_, _) if full.
impossible slide(B, _) if -hand_at(target(beam(B))).
impossible slide(B, L) if -push_by(B, L).
impossible slide(B, _) if -deep(B).

action push(beam, link).
push(B, L) causes aligned(B).
impossible push(_, _) if full.
impossible push(B, _) if -hand_at(target(beam(B))).
impossible push(B, L) if -push_by(B, L).
impossible push(B, _) if deep(B).

action fasten(connection).
fasten(C) causes pinned(C), hand_at(target(hole(C))).
impossible fasten(C) if -in_hand(peg(C)).
impossible fasten(C) if -hand_at(approach(hole(C))).

initially hand_at(above(input)).
