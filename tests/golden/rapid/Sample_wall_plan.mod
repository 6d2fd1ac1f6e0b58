MODULE mp_Sample_wall_plan
! written by millpose for ABB IRC5 and OmniCore (RAPID); mm, degrees, quaternions with the real part first
! job: Sample wall-plan
! cell: kr500_r2830
! inputs: 0123456789abcdef
LOCAL PERS tooldata mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
LOCAL PERS wobjdata mp_wobj:=[FALSE,TRUE,"",[[2076,30,1006],[0.70710677,0,-0.70710677,0]],[[0,0,0],[1,0,0,0]]];
LOCAL CONST speeddata mp_way:=[500,200,5000,1000];
LOCAL CONST speeddata mp_v1:=[1.33333,200,5000,1000];
LOCAL CONST zonedata mp_z1:=[FALSE,0.5159,0.5159,0.5159,90,1000,90];
LOCAL CONST zonedata mp_z2:=[FALSE,1.9999,1.9999,1.9999,90,1000,90];
LOCAL CONST zonedata mp_z3:=[FALSE,2,2,2,90,1000,90];
LOCAL CONST zonedata mp_z4:=[FALSE,0.1236,0.1236,0.1236,90,1000,90];
PROC Sample_wall_plan()
ConfJ\On;
ConfL\On;
SingArea\Off;
PDispOff;
EOffsOff;
SoftDeact;
VelSet 100,5000;
AccSet 100,100;
PathAccLim FALSE,FALSE;
WorldAccLim\Off;
GripLoad load0;
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,TRUE,"",[[2076,30,1006],[0.70710677,0,-0.70710677,0]],[[0,0,0],[1,0,0,0]]];
MoveAbsJ [[0,-90,90,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[5,-95,100,10,20,-10],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
! PASS 0 PIECE 0
MoveAbsJ [[14.855268,-34.277542,106.348961,-83.316635,116.385277,70.601089],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
SetAO spindle,7000;
SetDO do1,1;
MoveL [[-10,-4,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[-6,-4,0],[0,0.83148807,0.55554265,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[-2,-4,0],[0,0.83148807,0.55554265,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[2,-4,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z2,mp_tool\WObj:=mp_wobj;
MoveL [[6,-4,0],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[10,-4,0],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[10,-4,50],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
! END OF PASS 0 PIECE 0
! PASS 1 PIECE 0
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,TRUE,"",[[2076,30,1006],[0.70710677,0,-0.70710677,0]],[[0,0,0],[1,0,0,0]]];
MoveAbsJ [[14.613874,-35.205593,106.700768,-83.834129,116.374763,69.952484],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveL [[10,4,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[6,4,0],[0,0.83148807,0.55554265,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[2,4,0],[0,0.83148807,0.55554265,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[-2,4,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z3,mp_tool\WObj:=mp_wobj;
MoveL [[-6,4,0],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[-10,4,0],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[-10,4,50],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
! END OF PASS 1 PIECE 0
! PASS 2 PIECE 0
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,TRUE,"",[[2076,30,1006],[0.70710677,0,-0.70710677,0]],[[0,0,0],[1,0,0,0]]];
MoveAbsJ [[14.734637,-35.643902,106.746239,-83.911713,116.455193,69.520966],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveL [[20,0,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[17.3205,10,0],[0,0.83250338,0.55401999,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[10,17.3205,0],[0,0.83148807,0.55554265,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[0,20,0],[0,0.83111572,0.55609947,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[-10,17.3205,0],[0,0.83148807,0.55554265,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[-17.3205,10,0],[0,0.83250338,0.55401999,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[-20,0,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[-17.3205,-10,0],[0,0.83526307,0.54985052,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[-10,-17.3205,0],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[0,-20,0],[0,0.83663505,0.54776067,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[10,-17.3205,0],[0,0.83626795,0.54832101,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[17.3205,-10,0],[0,0.83526307,0.54985052,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,mp_z4,mp_tool\WObj:=mp_wobj;
MoveL [[20,0,0],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[20,0,50],[0,0.83388585,0.55193698,0],[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
! END OF PASS 2 PIECE 0
SetDO do1,0;
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,TRUE,"",[[2076,30,1006],[0.70710677,0,-0.70710677,0]],[[0,0,0],[1,0,0,0]]];
MoveAbsJ [[5,-95,100,10,20,-10],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[0,-90,90,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
ENDPROC
PROC main()
Sample_wall_plan;
ENDPROC
ENDMODULE
