MODULE mp_Sample_wall_plan
! written by millpose for ABB IRC5 and OmniCore (RAPID); mm, degrees, quaternions with the real part first
! job: Sample wall-plan
! cell: kr500_r2830
! inputs: 0123456789abcdef
LOCAL PERS tooldata mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
LOCAL PERS wobjdata mp_wobj:=[FALSE,FALSE,"STN1",[[0,0,0],[1,0,0,0]],[[-400,0,506],[0.70710677,0,-0.70710677,0]]];
LOCAL CONST speeddata mp_way:=[500,200,5000,1000];
LOCAL CONST speeddata mp_v1:=[1.33333,200,5000,1000];
LOCAL CONST zonedata mp_z1:=[FALSE,0.2234,0.2234,0.2234,90,1000,90];
LOCAL CONST zonedata mp_z2:=[FALSE,1.9999,1.9999,1.9999,90,1000,90];
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
ActUnit TRACK1;
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,FALSE,"STN1",[[0,0,0],[1,0,0,0]],[[-400,0,506],[0.70710677,0,-0.70710677,0]]];
MoveAbsJ [[0,-90,90,0,0,0],[0,0,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[0,-90,90,0,0,0],[100,5,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[5,-95,100,10,20,-10],[100,5,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
! PASS 0 PIECE 0
MoveAbsJ [[14.855268,-34.458195,106.39595,-83.382523,116.400757,70.452881],[100,5,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
SetAO spindle,7000;
SetDO do1,1;
MoveL [[-6,130.497,-9.8891],[0.03637359,0.83309215,0.55141169,-0.02407515],[0,-1,0,0],[100,5,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[-2,130.497,-9.8891],[0.03625276,0.83032471,0.55557019,-0.02425672],[0,-1,0,0],[100,5,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[2,130.497,-9.8891],[0.03637359,0.83309215,0.55141169,-0.02407515],[0,-1,0,0],[100,5,9E9,9E9,9E9,9E9]],mp_v1,mp_z2,mp_tool\WObj:=mp_wobj;
MoveL [[6,130.497,-9.8891],[0.03649351,0.83583879,0.5472393,-0.02389299],[0,-1,0,0],[100,5,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[6,134.8548,39.9207],[0.03649351,0.83583879,0.5472393,-0.02389299],[0,-1,0,0],[100,5,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
! END OF PASS 0 PIECE 0
SetDO do1,0;
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,FALSE,"STN1",[[0,0,0],[1,0,0,0]],[[-400,0,506],[0.70710677,0,-0.70710677,0]]];
MoveAbsJ [[5,-95,100,10,20,-10],[100,5,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[0,-90,90,0,0,0],[100,5,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[0,-90,90,0,0,0],[400,35,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[5,-95,100,10,20,-10],[400,35,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
! PASS 1 PIECE 0
MoveAbsJ [[14.613874,-35.024975,106.656609,-83.766884,116.360031,70.103897],[400,35,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
SetAO spindle,7000;
SetDO do1,1;
MoveL [[6,560.368,-304.0641],[0.2507543,0.79529107,0.52639169,-0.16597065],[0,-1,0,0],[400,35,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[2,560.368,-304.0641],[0.24992132,0.79264915,0.53036153,-0.16722235],[0,-1,0,0],[400,35,9E9,9E9,9E9,9E9]],mp_v1,mp_z1,mp_tool\WObj:=mp_wobj;
MoveL [[-2,560.368,-304.0641],[0.2507543,0.79529107,0.52639169,-0.16597065],[0,-1,0,0],[400,35,9E9,9E9,9E9,9E9]],mp_v1,mp_z2,mp_tool\WObj:=mp_wobj;
MoveL [[-6,560.368,-304.0641],[0.25158101,0.79791307,0.52240866,-0.16471481],[0,-1,0,0],[400,35,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
MoveL [[-6,589.0468,-263.1064],[0.25158101,0.79791307,0.52240866,-0.16471481],[0,-1,0,0],[400,35,9E9,9E9,9E9,9E9]],mp_v1,fine,mp_tool\WObj:=mp_wobj;
! END OF PASS 1 PIECE 0
SetDO do1,0;
mp_tool:=[TRUE,[[-250,0,250],[0.70710677,0,-0.70710677,0]],[85,[-120,0,130],[1,0,0,0],4,5,6]];
mp_wobj:=[FALSE,FALSE,"STN1",[[0,0,0],[1,0,0,0]],[[-400,0,506],[0.70710677,0,-0.70710677,0]]];
MoveAbsJ [[5,-95,100,10,20,-10],[400,35,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[0,-90,90,0,0,0],[400,35,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
MoveAbsJ [[0,-90,90,0,0,0],[0,0,9E9,9E9,9E9,9E9]]\NoEOffs,mp_way,fine,mp_tool\WObj:=mp_wobj;
ENDPROC
PROC main()
Sample_wall_plan;
ENDPROC
ENDMODULE
